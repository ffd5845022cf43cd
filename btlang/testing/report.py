"""The results of tests, for people and as JUnit XML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from xml.etree import ElementTree

from btlang.support.record import Record
from btlang.testing.runner import Result, brief_time
from btlang.text.escaping import one_line


class Summary(Record):
    """The results of one test: one for each seed; `recording` is the path of the recording of the first failure."""

    results: tuple[Result, ...]
    recording: str = ""

    @property
    def failures(self) -> list[Result]:
        """Those that did not pass, by their seeds."""
        return [result for result in self.results if not result.passed]


def lines(summary: Summary, *, has_seeds: bool) -> Iterable[str]:
    """What is shown of a test: a line, and of one that failed why."""
    first, failures = summary.results[0], summary.failures
    seconds = sum(result.seconds for result in summary.results)
    if not failures:
        times = f"{len(summary.results)} times, " if has_seeds else ""
        yield one_line(f"ok      {first.place}: {first.name} ({times}{brief_time(seconds)})")
        return
    shown = failures[0]
    yield one_line(f"{'CUT' if shown.is_cut else 'FAILED':7} {first.place}: {first.name}")
    if has_seeds:
        again = f"btc test --seed {shown.seed} {first.place.rpartition(':')[0]}"
        yield one_line(f"  {len(failures)} of {len(summary.results)} failed; the first: {again}")
    yield from (f"  {line}" for line in shown.problem.splitlines())
    if summary.recording:
        yield f"  recorded in {summary.recording}"


def ending(summaries: Sequence[Summary]) -> str:
    """The last line."""
    failed = sum(bool(summary.failures) for summary in summaries)
    mission_time = sum(result.seconds for summary in summaries for result in summary.results)
    count = f"{len(summaries)} test{'s' * (len(summaries) != 1)}"
    result = f"{failed} of {count} failed" if failed else f"{count} passed"
    return f"{result} ({brief_time(mission_time)} of mission time)"


def junit(summaries: Iterable[Summary]) -> str:
    """The results as JUnit XML, as CI servers read it: a suite for each file, a case for each test."""
    suites = ElementTree.Element("testsuites")
    files: dict[str, ElementTree.Element] = {}
    for summary in summaries:
        first = summary.results[0]
        file, _, line = first.place.rpartition(":")
        suite = files.get(file)
        if suite is None:
            suite = files[file] = ElementTree.SubElement(suites, "testsuite", name=file, tests="0", failures="0")
        suite.set("tests", str(int(suite.get("tests", "0")) + 1))
        seconds = sum(result.seconds for result in summary.results)
        case = ElementTree.SubElement(
            suite, "testcase", name=_printable(first.name), classname=file, file=file, line=line, time=f"{seconds:.3f}"
        )
        if summary.failures:
            suite.set("failures", str(int(suite.get("failures", "0")) + 1))
            shown = summary.failures[0]
            failure = ElementTree.SubElement(case, "failure", message=_printable(shown.problem.splitlines()[0]))
            failure.text = _printable(f"{shown.problem}\nseed {shown.seed}")
    ElementTree.indent(suites)
    return ElementTree.tostring(suites, "unicode", xml_declaration=True) + "\n"


def _printable(text: str) -> str:
    """Without the characters that XML cannot have."""
    return "".join(character if character >= " " or character in "\n\t" else "?" for character in text)

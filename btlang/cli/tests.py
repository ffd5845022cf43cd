"""The verb `test`: finds files of tests, runs them on all cores and reports, for people and as JUnit XML."""

from __future__ import annotations

import os
import platform
import re
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from functools import cache, partial
from xml.etree import ElementTree

from btlang.cli.examples import path_of
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.diagnostics.files import read_source, write_file
from btlang.support.record import Record
from btlang.support.test_files import ENDING, is_test_file
from btlang.testing.observations import measure_coverage
from btlang.testing.runner import Result, brief_time, run_chaos, run_test
from btlang.testing.test import MissionTest
from btlang.testing.test_file import read_tests
from btlang.text.formatting import one_line
from btlang.text.output import show
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


class Summary(Record):
    """The results of one test: one for each seed; `recording` is the path of the recording of the first failure."""

    results: tuple[Result, ...]
    recording: str = ""

    @property
    def failures(self) -> list[Result]:
        """The results that did not pass, by their seeds."""
        return [result for result in self.results if not result.passed]


def format_summary(summary: Summary, *, has_seeds: bool) -> Iterable[str]:
    """Return what is shown of a test: a line, and of one that failed why."""
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


def format_ending(summaries: Sequence[Summary]) -> str:
    """Return the last line."""
    failed = sum(bool(summary.failures) for summary in summaries)
    mission_time = sum(result.seconds for summary in summaries for result in summary.results)
    count = f"{len(summaries)} test{'s' * (len(summaries) != 1)}"
    result = f"{failed} of {count} failed" if failed else f"{count} passed"
    return f"{result} ({brief_time(mission_time)} of mission time)"


def junit(summaries: Iterable[Summary]) -> str:
    """Return the results as JUnit XML, as CI servers read it: a suite for each file, a case for each test."""
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
    """Return a text without the characters that XML cannot have."""
    return "".join(character if character >= " " or character in "\n\t" else "?" for character in text)


_FEW = 4  # tests that are sooner done than another process has begun
_SKIPPED = ("node_modules", "__pycache__", "venv")


def run_tests(options: argparse.Namespace) -> int:
    """Run the tests that the options name; return the exit code. Raises MissionError at the end for unread files."""
    tests, unread = _tests(options)
    seeds = tuple(range(options.seed, options.seed + options.repeat))
    summaries: list[Summary] = []
    for summary in _results(tests, seeds, options):
        summaries.append(summary)
        if not options.quiet or summary.failures:
            show("\n".join(format_summary(summary, has_seeds=len(seeds) > 1)))
    if options.coverage:
        runs = zip(tests, summaries, strict=True)
        seen = ((test, result.seen) for (_, _, test), summary in runs for result in summary.results)
        for name, coverage in measure_coverage(seen).items():
            show("\n".join(["", *coverage.lines(name)]))
    if options.junit is not None:
        write_file(options.junit, junit(summaries))
    show(format_ending(summaries))
    if unread:
        raise MissionError(unread)
    return 1 if any(summary.failures for summary in summaries) else 0


def _tests(options: argparse.Namespace) -> tuple[list[tuple[str, int, MissionTest]], list[Diagnostic]]:
    """Return path, number and content of each test, and what is wrong with files that can't be read.

    Raises MissionError if there are no tests.
    """
    problems, found = list[Diagnostic](), list[tuple[str, int, MissionTest]]()
    for path in find_files(options.path or ["."]):
        try:
            read = read_tests(read_source(path, options.include_root))
        except MissionError as error:
            is_mission = not is_test_file(path) and all(each.code == "BT180" for each in error.diagnostics)
            problems += [_no_tests(path)] if is_mission else error.diagnostics
            continue
        wanted = (options.name or "").casefold()
        found += [(path, number, test) for number, test in enumerate(read) if wanted in test.name.casefold()]
    if not problems and not found:
        problems.append(_no_tests(", ".join(options.path or ["this folder"])))
    if not found:
        raise MissionError(problems)
    return found, problems


def _no_tests(path: str) -> Diagnostic:
    return diagnostic("BT184", Span(Source("", path), 0, 0), path=path)


def find_files(paths: Sequence[str]) -> list[str]:
    """Find the files of tests, those in folders by their names. A file that is named is one."""
    found: list[str] = []
    for path in paths:
        if not os.path.isdir(path):
            found.append(_test_of(path))
            continue
        for folder, folders, files in os.walk(path):
            folders[:] = sorted(name for name in folders if name[0] != "." and name not in _SKIPPED)
            found += [os.path.normpath(os.path.join(folder, name)) for name in sorted(files) if name.endswith(ENDING)]
    return list(dict.fromkeys(found))


def _test_of(path: str) -> str:
    """Return the file of tests of a mission or of an example, where that is named; any other path stays."""
    folder, name = os.path.split(path)
    if name.endswith(ENDING):
        return path
    beside = (os.path.join(folder, *place, f"{name.removesuffix('.txt')}{ENDING}") for place in ((), ("tests",)))
    there = next(filter(os.path.isfile, beside), "")
    return there or (path_of(path, test=True) if not os.path.lexists(path) and path.isidentifier() else "") or path


def _results(
    tests: Sequence[tuple[str, int, MissionTest]], seeds: Sequence[int], options: argparse.Namespace
) -> Iterator[Summary]:
    """Give the results in the order of the tests, each as soon as it is there."""
    most = min(options.jobs or os.cpu_count() or 1, len(tests))
    if most == 1 or len(tests) * len(seeds) <= _FEW:
        for _, _, test in tests:
            yield _summary(test, seeds, options.keep, options.chaos)
        return
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(most, get_context("spawn")) as pool:
        run = partial(_run, seeds=seeds, keep=options.keep, include_root=options.include_root, chaos=options.chaos)
        try:
            yield from pool.map(run, *zip(*((path, number) for path, number, _ in tests), strict=True))
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            raise


def _run(path: str, number: int, *, seeds: Sequence[int], keep: str, include_root: str | None, chaos: bool) -> Summary:
    """Run a test by its file and number there: a test itself cannot go to another process."""
    return _summary(_read(path, include_root)[number], seeds, keep, chaos)


@cache
def _read(path: str, include_root: str | None) -> tuple[MissionTest, ...]:
    return read_tests(read_source(path, include_root))


def _summary(test: MissionTest, seeds: Sequence[int], keep: str, chaos: bool) -> Summary:
    run = run_chaos if chaos else run_test
    results = tuple(_result(run, test, seed) for seed in seeds)
    failed = next((result for result in results if not result.passed), None)
    return Summary(results, "" if failed is None else _record_failure(run, test, failed, keep))


def _result(run: Callable[..., Result], test: MissionTest, seed: int) -> Result:
    """Run a test; a mission that can't run has failed it."""
    try:
        return run(test, seed)
    except MissionError as error:
        problem = "\n".join(f"{one.span.place}: {one.message}" for one in error.diagnostics)
        return Result(test.name, test.place, seed, 0.0, problem)


def _record_failure(run: Callable[..., Result], test: MissionTest, failed: Result, folder: str) -> str:
    """Run a test that failed again, and return the path of its recording, or "" if nothing can be written.

    The run is the same each time, so it's only recorded when somebody will want to see it.
    """
    import btlang
    from btlang.recording.bundle import files_of
    from btlang.recording.recorder import Recorder

    name = re.sub(r"\W+", "-", f"{os.path.basename(test.span.source.name).removesuffix(ENDING)}-{test.name}").strip("-")
    path = os.path.join(folder, f"{name[:80]}-{failed.seed}.mcap")
    about = {
        "btlang": btlang.__version__, "python": platform.python_version(), "wall": f"{time.time():.3f}",
        "mission": f"the test '{test.name}'", "seed": str(failed.seed), "robot": "simulated",
    }  # fmt: skip
    with suppress(MissionError, OSError):
        os.makedirs(folder, exist_ok=True)
        recorder = Recorder(path, test.mission.label, files_of(test.mission, ()), about)
        try:
            again = run(test, failed.seed, sinks=[recorder])
        finally:
            recorder.close()
        return path if not again.passed else f"{path} (it passed when it ran again)"
    return ""

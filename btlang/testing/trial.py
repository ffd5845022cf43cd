"""Tests of a mission that somebody writes: run in the simulated world, within limits, with films of those that fail."""

from __future__ import annotations

import time
from collections.abc import Iterator
from threading import Event, Timer

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.document import offsets
from btlang.recording.film import Film, check_words
from btlang.run.controls import Controls
from btlang.testing.runner import Result, run_test
from btlang.testing.test import MissionTest
from btlang.testing.test_file import read_tests
from btlang.text.source import Source, Span
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.testing.test_file import Given

_OF_TESTS = "btlang.testing.words:"  # what the words of tests do: they ask about the run, or change the simulated world
_MOST_FILMS = 3
_OVER = "it took too long to simulate"


def results_of(source: Source, given: Given, patience: float = 6.0) -> dict[str, Any]:
    """Return the results of the tests in a text; `given` as for `read_tests`.

    They take `patience` seconds of real time.

    - `problems`: what is wrong with the text, so that nothing runs: `line` (from 1; 0: it is elsewhere), `code` and
    `message`. Words that are no words of btlang are a problem (BT221);
    - `results`: of each test its `name` and `line`, whether it `passed` (None: there was no time left), and the
    `seconds` of the mission. Of one that failed also the `problem`; `at`, the line that did not hold (0: none);
    `start` and `end`, the characters of the given mission that it was at (None: none); of the first ones the `film`
    (btlang.recording.film), without words if the mission is another one.
    """
    own: list[Mission] = []

    def noted(name: str, world: str | None) -> Mission | None:
        mission = given(name, world)
        own.extend([mission] if mission is not None else [])
        return mission

    try:
        tests = read_tests(source, noted)
        for test in tests:
            _check(test)
    except MissionError as error:
        problems = [
            {"line": _line(each.span, source), "code": each.code, "message": each.message} for each in error.diagnostics
        ]
        return {"problems": problems, "results": []}
    return {"problems": [], "results": list(_results(tests, own, source, patience))}


def _check(test: MissionTest) -> None:
    """Raise MissionError."""
    mission = test.mission
    check_words(mission.tree, mission.vocabulary, mission.label)
    for tree in _trees(test):
        check_words(tree, test.vocabulary, mission.label, _OF_TESTS)


def _trees(test: MissionTest) -> Iterator[Tree]:
    yield from test.setup
    for step in test.steps:
        yield from (tree for tree in (step.condition, step.other, step.event) if tree is not None)


def _results(
    tests: tuple[MissionTest, ...], own: list[Mission], source: Source, patience: float
) -> Iterator[dict[str, Any]]:
    until, films = time.monotonic() + patience, 0
    for test in tests:
        film, left = Film(test.mission), until - time.monotonic()
        entry: dict[str, Any] = {"name": test.name, "line": _line(test.span, source), "passed": None, "seconds": 0.0}
        if left > 0:
            result = _run(test, film, left)
            entry |= {"passed": result.passed, "seconds": result.seconds}
            if not result.passed:
                films += 1
                mission = next((each for each in own if each is test.mission), None)
                entry |= {
                    "problem": result.problem, "at": _line(result.line, source),
                    **_place(result.at, mission), "film": _data(film, mission) if films <= _MOST_FILMS else None,
                }  # fmt: skip
        yield entry


def _run(test: MissionTest, film: Film, patience: float) -> Result:
    controls, late = Controls(), Event()

    def end() -> None:
        late.set()
        controls.stop()

    timer = Timer(patience, end)
    timer.start()
    try:
        result = run_test(test, sinks=[film], controls=controls)
    except MissionError as error:
        return Result(test.name, test.place, 0, 0.0, str(error))
    finally:
        timer.cancel()
    return result.replace(problem=_OVER) if late.is_set() else result


def _place(span: Span | None, mission: Mission | None) -> dict[str, int | None]:
    """Return the characters of the given mission, if it's that."""
    if mission is None or mission.syntax is None:
        return {"start": None, "end": None}
    return offsets(span, mission.syntax.span.source)


def _data(film: Film, mission: Mission | None) -> dict[str, Any]:
    """Return the data of a film, without the text and places of a mission that isn't the given one."""
    data = film.data()
    if mission is None:
        data |= {"text": "", "nodes": [{**node, "start": None, "end": None} for node in data["nodes"]]}
    return data


def _line(span: Span | None, source: Source) -> int:
    return source.text.count("\n", 0, span.start) + 1 if span is not None and span.source is source else 0

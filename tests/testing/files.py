"""Tests of missions as texts, for the tests of `btc test`."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import indent

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.testing.runner import Result, run_test
from btlang.testing.test import MissionTest
from btlang.testing.test_file import read_tests
from btlang.text.source import Source


def mission_test(mission: str, *lines: str, before: Sequence[str] = ()) -> MissionTest:
    """A test with a mission in it, and lines behind and before that."""
    text = "\n".join(['test "t":', *(f"  {line}" for line in before), "  run:", indent(mission, "    ")])
    [test] = read_tests(Source("\n".join([text, *(f"  {line}" for line in lines)]), "t.test.txt"))
    return test


def ran(mission: str, *lines: str, before: Sequence[str] = (), seed: int = 0) -> Result:
    """The result of such a test."""
    return run_test(mission_test(mission, *lines, before=before), seed)


def passes(mission: str, *lines: str, before: Sequence[str] = ()) -> bool:
    """Whether it passes."""
    return ran(mission, *lines, before=before).passed


def told(text: str) -> list[Diagnostic]:
    """What is wrong with a file of tests."""
    try:
        read_tests(Source(text, "t.test.txt"))
    except MissionError as error:
        return error.diagnostics
    return []


def codes(text: str) -> list[str]:
    """The codes of that."""
    return [problem.code for problem in told(text)]

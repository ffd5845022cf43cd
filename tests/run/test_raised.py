"""Conditions and actions that raise an exception: nothing is decided by it, and people hear of it once."""

from __future__ import annotations

from typing import Any

import pytest

import btlang
from btlang import ActionFailed, Failed, Status
from btlang.run.events import Event, Warned
from btlang.run.logs import PlainLines

DONE: list[str] = []
JAMMED = ZeroDivisionError("no pulse in the last second")


@btlang.condition("the gate is jammed")
def jammed() -> bool:
    raise JAMMED


@btlang.condition("the gate is shut")
def shut() -> Any:
    return "shut"


@btlang.condition("the gate is away")
def away() -> bool:
    raise ActionFailed("the gate's board isn't there now")


@btlang.condition("the gate is open")
def opened() -> Any:
    return Failed("it is ajar")


@btlang.quantity("the gap", type="number")
def gap() -> float:
    return float("nan")


@btlang.action("open the gate")
def open_gate() -> None:
    raise OSError("no current")


@btlang.action("note")
def note() -> None:
    DONE.append("note")


WORDS: list[Any] = [jammed, shut, away, opened, gap, open_gate, note]


def run(text: str) -> tuple[btlang.Outcome, list[str]]:
    """How a mission ended, and its warnings."""
    DONE.clear()
    warnings: list[str] = []

    def sink(event: Event) -> None:
        if isinstance(event, Warned):
            warnings.append(event.text)

    mission = btlang.parse_tree(text, keywords=WORDS)
    return mission.run(speed="max", time_limit=2.0, sinks=[sink]), warnings


@pytest.mark.parametrize(
    ("condition", "reason"),
    [
        ("the gate is jammed", "ZeroDivisionError: no pulse in the last second"),
        ("the gate is shut", "it returned 'shut', which is neither True, False, None nor a status"),
        ("the gate is away", "the gate's board isn't there now"),
        ("the gap is above 5", "it is not a number"),
    ],
)
@pytest.mark.parametrize(
    "mission",
    ["unless {}, note", "if {}, note, otherwise note", "if not {}, note", "while not {}, note", "note until {}"],
)
def test_what_depends_on_a_condition_that_raises_fails(mission: str, condition: str, reason: str) -> None:
    outcome, warnings = run(mission.format(condition))
    assert (outcome.status, DONE) == (Status.FAILURE, [])
    assert outcome.failure is not None
    assert outcome.failure.reason == reason
    [warning] = warnings
    assert f"{condition.removeprefix('the ')}' is not known: {reason}" in warning


def test_a_reason_alone_still_means_no() -> None:
    outcome, warnings = run("unless the gate is open, note")
    assert (outcome.status, DONE, warnings) == (Status.SUCCESS, ["note"], [])


def test_a_standing_rule_reports_it_once_and_goes_on() -> None:
    outcome, warnings = run("whenever the gate is jammed, note; wait 1 second")
    assert (outcome.status, DONE) == (Status.SUCCESS, [])
    warning, ending = warnings
    assert [ending] == list(outcome.unanswered)
    assert "gate is jammed' is not known: ZeroDivisionError: no pulse" in warning
    assert " (raised in jammed, test_raised.py:" in warning


def test_an_action_that_raises_is_reported_once_also_where_the_mission_goes_on() -> None:
    outcome, warnings = run("try open the gate up to 3 times, otherwise note")
    assert (outcome.status, DONE) == (Status.SUCCESS, ["note"])
    [warning] = warnings
    assert warning.startswith("'open the gate' failed: OSError: no current (raised in open_gate, test_raised.py:")


def test_an_exception_that_was_caught_is_on_the_outcome_and_printed_with_it_once() -> None:
    outcome, _ = run("try open the gate up to 3 times, otherwise note")
    [problem] = outcome.exceptions
    assert isinstance(problem, OSError)
    first, caught = str(outcome).splitlines()
    assert first == "The mission succeeded in 0.1 s."
    assert caught.startswith(
        "'open the gate' raised an exception: OSError: no current (raised in open_gate, test_raise"
    )
    assert repr(outcome) == "<Outcome SUCCESS after 0.1 s, 1 exception caught>"


@pytest.mark.parametrize("mission", ["open the gate", "whenever the gate is jammed, note; open the gate"])
def test_the_exception_that_ended_a_mission_is_printed_once(mission: str) -> None:
    outcome, _ = run(mission)
    text = str(outcome)
    assert (outcome.status, text.count("raised in open_gate, test_raised.py:")) == (Status.FAILURE, 1)
    assert text.count("raised in jammed") == mission.count("jammed")


def test_a_run_is_printed_as_its_outcome() -> None:
    with btlang.Session(keywords=WORDS) as session:
        run = session.run("try open the gate, otherwise note", speed="max")
        assert str(run) == str(run.outcome)
        assert "raised in open_gate" in str(run)


def test_lines_of_a_run_say_an_exception_once(capsys: pytest.CaptureFixture[str]) -> None:
    lines: list[str] = []
    mission = btlang.parse_tree("try open the gate up to 3 times, otherwise note", keywords=WORDS)
    mission.run(speed="max", sinks=[PlainLines(mission.label, mission.is_action, lines.append)])
    assert sum("no current" in line for line in lines) == 1
    assert sum(line.endswith("failed open the gate") for line in lines) == 3

"""What a test expects: the conditions of the language, over time."""

from __future__ import annotations

import pytest

from tests.testing.files import passes, ran

GO = "go to the lab, then say hello"


@pytest.mark.parametrize(
    ("mission", "line", "holds"),
    [
        (GO, "finally the mission succeeds", True),
        (GO, "finally the mission fails", False),
        ("dock then fail", "finally the mission fails", True),
        ("dock then fail", "finally the mission is over and the robot is docked", True),
        (GO, "finally it has said hello", True),
        (GO, 'finally it has said "Hello!"', True),
        (GO, "finally it has said bye", False),
        (GO, "finally it has never said bye", True),
        ("say hello 3 times", "finally it has said hello 3 times", True),
        ("say hello 3 times", "finally it has said hello twice", False),
        ("print hello", "finally it has printed hello and it has never said hello", True),
        (GO, "finally it has reached the lab and it has never been to the hall", True),
        ("go to Alice", "finally it has reached Alice", True),
        (GO, 'finally it has done "go to the lab"', True),
        ("wave\nwave", 'finally it has done "wave" twice', True),
        ("repeat 3 times wave", 'finally it has done "wave" 3 times and it has tried "wave" 3 times', True),
        ("pick up the cup", 'finally it has failed to "pick up"', False),
        ("if the battery is low, wave, otherwise nod", 'finally it has never tried "wave"', True),
        ("patrol is wave then nod\npatrol\npatrol", 'finally it has done "patrol" twice', True),
        ("set goal to the lab; go to {goal}", 'finally it has done "go to the lab"', True),
        ("set counter to 3; wave", "finally counter is 3", True),
        ("set counter to 3; wave", "finally counter is 4", False),
        (GO, "within 30 s the robot is at the lab", True),
        (GO, "within 2 s the robot is at the lab", False),
        (GO, "then within 1 minute it has said hello", True),
        (GO, "for 5 s it has never said hello", True),
        (GO, "for 5 s it stands still", False),
        (GO, "after 1 s it is doing \"go to the lab\"", True),
        (GO, "after 1 s it has said hello", False),
        (GO, "before it has said hello, the robot is at the lab", True),
        (GO, "before the robot is at the lab, it has said hello", False),
        (GO, "always the battery is above 50%", True),
        (GO, "always it stands still", False),
        (GO, "never the robot is at the hall", True),
        (GO, "never the robot is at the lab", False),
        (GO, "finally the mission time is below 1 minute and the distance travelled is above 1 m", True),
        (GO, "finally the distance travelled is below 1 m", False),
        ("turn left forever", "after 5 minutes the mission is over", False),
    ],
)  # fmt: skip
def test_one_line(mission: str, line: str, holds: bool) -> None:
    assert passes(mission, line) == holds


def test_lines_follow_each_other() -> None:
    lines = "within 30 s the robot is at the lab", "then within 20 s it has said hello"
    assert passes("wave, go to the lab, then say hello", *lines)
    assert not passes("wave, say hello, then go to the hall", *lines)


def test_what_always_holds_begins_where_it_stands() -> None:
    mission = "move forward 1 m, wait 20 s"
    assert not passes(mission, "always it stands still")
    assert passes(mission, "after 10 s it stands still", "always it stands still")


def test_what_is_waited_for_may_be_how_the_mission_ends() -> None:
    assert passes(GO, "then within 1 minute the mission succeeds")


def test_a_line_that_the_mission_never_reaches() -> None:
    result = ran("wave", "after 1 hour the battery is above 10%")
    assert "the mission was over" in result.problem
    assert result.problem.startswith("t.test.txt:4: after 1 hour the battery is above 10%")


def test_what_did_not_hold_says_when_why_and_what_the_mission_did() -> None:
    result = ran("go to the lab", "within 3 s it has said hello")
    assert result.problem.splitlines() == [
        "t.test.txt:4: within 3 s it has said hello",
        "  after 3.0 s: it is not true",
        "  the mission was at: go to lab",
    ]


def test_the_failure_of_the_mission_is_said() -> None:
    assert "the mission failed: fail" in ran("wave\nfail", "finally the mission succeeds").problem


def test_what_is_not_known_neither_holds_nor_does_it_not() -> None:
    broken = "the scanner falls silent"
    for line in ("never the distance ahead is below 10 cm", "always the distance ahead is above 10 cm"):
        assert "silent" in ran("wait 5 s", broken, line).problem


def test_a_test_that_takes_too_long_is_cut() -> None:
    result = ran("repeat forever: turn left", "finally the mission succeeds")
    assert result.is_cut
    assert result.problem == "cut after 10 min 0.0 s: the mission was not over"


def test_nothing_to_wait_for_ends_the_test() -> None:
    result = ran("repeat forever: turn left", "after 3 s the battery is above 10%")
    assert result.passed
    assert result.seconds == pytest.approx(3.0, abs=0.1)

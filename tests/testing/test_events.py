"""What a test lets happen in the world, and what stands in for commands."""

from __future__ import annotations

import pytest

from btlang.testing.runner import run_test
from tests.testing.files import mission_test, passes, ran

LONG = "wait 20 s"


@pytest.mark.parametrize(
    ("mission", "lines"),
    [
        (LONG, ("after 5 s the battery drops to 15%", "then the battery is below 16%")),
        ("go to the lab or say blocked", ("the way to the lab becomes blocked", "finally it has said blocked")),
        (
            "go to the lab or say blocked",
            ("the way to the lab becomes blocked", "the way to the lab becomes free", "finally the mission succeeds"),
        ),
        (LONG, ("the scanner fails", "after 1 s the scanner works again", "for 3 s the distance ahead is above 0 m")),
        ("move forward 1 m", ("the wheels slip", "finally the mission fails")),
        ("move forward 1 m", ("the wheels slip", "after 0.5 s the wheels grip again", "finally the mission succeeds")),
        (LONG, ("Alice moves to (1, 1)", "then the distance to Alice is below 3 m")),
        (LONG, ("the robot appears at the lab", "then the robot is at the lab")),
        (LONG, ("the robot appears at (2, 2) facing 90 degrees", "after 1 s it stands still")),
        ("go to the cup, pick up the cup, wait 5 s", (
            "when it has picked up the cup, the hands grow weak", "then within 1 s it has dropped something")),
        ("move forward 9 m", (
            "after 1 s somebody presses the emergency stop", "then within 2 s it stands still",
            "finally the mission is over")),
        (LONG, ("after 2 s somebody stops the mission", "finally the mission time is below 3 s")),
        (LONG, ("after 2 s the battery drops to 10% and the cup moves to (1, 1)", "then the battery is below 11%")),
    ],
)  # fmt: skip
def test_events(mission: str, lines: tuple[str, ...]) -> None:
    assert ran(mission, *lines).problem == ""


def test_what_is_there_at_the_start() -> None:
    before = ("with the battery at 25% and Alice at (2, 2)", "with the robot starting at the lab")
    assert passes("wait 1 s", "the robot is at the lab and the battery is below 26%", before=before)


def test_events_that_cannot_happen_fail_the_test() -> None:
    lines = "when it has picked up the cup, the cup moves to (1, 1)", "finally the mission succeeds"
    assert "can't be moved" in ran("go to the cup, pick up the cup, wait 5 s", *lines).problem


@pytest.mark.parametrize(
    ("mission", "fake", "line"),
    [
        ("wave or nod", '"wave" fails', 'finally it has done "nod"'),
        ("wave or nod", '"wave" fails', 'finally it has failed to "wave"'),
        ("retry wave up to 3 times", '"wave" fails twice', 'finally it has tried "wave" 3 times'),
        ("retry wave up to 3 times", '"wave" fails 3 times', "finally the mission fails"),
        ("retry wave up to 5 times", '"wave" fails 3 times, then succeeds', 'finally it has tried "wave" 4 times'),
        ("go to the lab\ngo to the hall", '"go to the hall" fails', "finally it has reached the lab"),
        ("go to the lab\ngo to the hall", '"go to" succeeds', "finally the distance travelled is below 0.1 m"),
        ("go to the lab", '"go to the lab" takes 7 s', "finally the mission time is at least 7 s"),
        ("wave within 3 s", '"wave" fails after 10 s', "finally the mission time is below 4 s"),
        ("if the path is clear, wave, otherwise nod", '"the path is clear" is false', 'finally it has done "nod"'),
        ("if bumped, wave, otherwise nod", '"bumped" is true', 'finally it has done "wave"'),
        ("if the battery is low, wave, otherwise nod", '"the battery is low" is true', 'finally it has done "wave"'),
        ("say hello", '"say" fails', "finally it has never said hello and the mission fails"),
    ],
)  # fmt: skip
def test_fakes(mission: str, fake: str, line: str) -> None:
    assert ran(mission, fake, line).problem == ""
    assert ran(mission, line, before=(fake,)).problem == ""


def test_a_fake_counts_anew_in_each_run() -> None:
    test = mission_test("wave or nod", '"wave" fails once', 'finally it has done "nod"')
    assert run_test(test).passed
    assert run_test(test).passed

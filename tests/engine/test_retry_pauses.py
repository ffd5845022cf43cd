"""A retry whose command lacks what isn't there now: attempts aren't over in a moment."""

from __future__ import annotations

from typing import Any

import pytest

import btlang
from btlang import ActionFailed, Failed, NotThere, Status, Unknown
from btlang.robots.platforms import ALL
from btlang.robots.registry import connector
from tests.components.robots import robot_file


def attempts(mission: str, reason: Any, back: float = 100.0) -> tuple[list[float], btlang.Outcome]:
    """When a command was tried, which fails so until the second `back`."""
    tried: list[float] = []

    @btlang.action("open the gate")
    def open_gate(clock: Any) -> Any:
        tried.append(round(clock.now, 2))
        if clock.now >= back:
            return True
        if isinstance(reason, Failed):
            return reason
        raise reason

    outcome = btlang.parse_tree(mission, keywords=[open_gate]).run(speed="max", time_limit=100.0)
    return tried, outcome


AWAY = NotThere("the board isn't there now")


@pytest.mark.parametrize("reason", [ActionFailed(AWAY), Failed(AWAY), Unknown("the board is silent")])
def test_pauses_grow_until_it_is_there(reason: Any) -> None:
    tried, outcome = attempts("retry open the gate 5 times", reason, back=3.0)
    assert (tried, outcome.status) == ([0.0, 0.5, 1.5, 3.5], Status.SUCCESS)


def test_it_fails_in_the_end() -> None:
    tried, outcome = attempts("retry open the gate 7 times", ActionFailed(AWAY))
    assert tried == [0.0, 0.5, 1.5, 3.5, 7.5, 15.5, 23.5]
    assert outcome.failure is not None
    assert outcome.failure.reason == AWAY
    assert type(outcome.failure.reason) is str


def test_other_failures_are_tried_again_at_once() -> None:
    tried, _ = attempts("retry open the gate 5 times", ActionFailed("it is locked"))
    assert tried == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2])


def test_a_time_that_is_said_counts() -> None:
    tried, _ = attempts("retry open the gate 4 times every 2 s", ActionFailed(AWAY))
    assert tried == pytest.approx([0.0, 2.0, 4.0, 6.0])


def test_a_halt_ends_the_pause() -> None:
    tried, _ = attempts(
        "repeat 2 times: try (retry open the gate 5 times) within 1 s, otherwise wait 0 s", ActionFailed(AWAY)
    )
    assert tried == pytest.approx([0.0, 0.5, 1.0, 1.5], abs=0.06)


def test_wheels_that_are_back_after_a_reboot(tmp_path: Any) -> None:
    wheels = '[[device]]\nname = "wheels"\nkind = "drive"\ndriver = "simulated"\noptions = { silent = [0, 3] }'
    robot = connector(robot_file(tmp_path, wheels), "devices", simulate=[ALL])
    with btlang.Session(robot) as session:
        outcome = session.run(btlang.parse_tree("retry move forward 0.3 m 5 times"), speed="max").outcome
    assert outcome is not None
    assert outcome.succeeded, outcome.why()

"""A journey to somebody who walks."""

from __future__ import annotations

from types import SimpleNamespace as Made
from typing import Any

import pytest

from btlang.robots.geometry import Point
from btlang.robots.robot import RobotError
from btlang.ros.robot.navigation import Pursuit


class Goal:
    """One that was sent."""

    def __init__(self) -> None:
        self.done = False
        self.failure: str | None = None

    def end(self, failure: str | None) -> None:
        if not self.done:
            self.done, self.failure = True, failure


class Chase:
    """A pursuit of Bob, and the goals that it sent."""

    def __init__(self) -> None:
        self.at: Point = (2.0, 2.0)
        self.fresh, self.refusal = True, ""
        self.goals: list[Goal] = []
        sight: Any = Made(where=lambda name: self.at, lost=lambda _: None if self.fresh else "I've lost sight of Bob")
        self.pursuit = Pursuit("Bob", sight, self.set_out, 0.0)  # type: ignore[arg-type]

    def set_out(self) -> Goal:
        if self.refusal:
            raise RobotError(self.refusal)
        self.goals.append(Goal())
        return self.goals[-1]


@pytest.fixture
def chase() -> Chase:
    return Chase()


def test_a_new_goal_where_somebody_is_seen_elsewhere(chase: Chase) -> None:
    for now, at, goals in ((0.5, (2.0, 3.0), 1), (2.0, (2.0, 3.0), 2), (3.0, (2.0, 9.0), 2), (5.0, (2.0, 3.2), 2)):
        chase.at = at
        chase.pursuit.step(now)
        assert len(chase.goals) == goals
    chase.goals[1].end(None)
    chase.pursuit.step(6.0)
    assert (chase.pursuit.done, chase.pursuit.failure) == (True, None)


def test_who_is_gone_at_the_end_is_lost(chase: Chase) -> None:
    chase.goals[0].end(None)
    chase.fresh = False
    chase.pursuit.step(1.0)
    assert chase.pursuit.failure == "I've lost sight of Bob"


def test_a_failure_is_that_of_the_goal(chase: Chase) -> None:
    chase.goals[0].end("the door is shut")
    chase.pursuit.step(1.0)
    assert chase.pursuit.failure == "the door is shut"


def test_cancelled_it_sends_nothing_more(chase: Chase) -> None:
    chase.pursuit.cancel()
    assert chase.goals[0].done
    chase.at = (9.0, 9.0)
    chase.pursuit.step(9.0)
    assert (len(chase.goals), chase.pursuit.failure) == (1, "the navigation to Bob was cancelled")


def test_a_new_goal_that_is_refused_ends_it(chase: Chase) -> None:
    chase.refusal, chase.at = "Bob is in the stairs, where the robot may not go", (9.0, 9.0)
    chase.pursuit.step(3.0)
    assert chase.pursuit.failure == chase.refusal
    assert chase.goals[0].done

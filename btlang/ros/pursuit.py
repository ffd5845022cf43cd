"""A journey to somebody who may walk meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from math import dist

from btlang.robots.geometry import Point
from btlang.robots.robot import RobotError
from btlang.robots.sight import Sight
from btlang.robots.world import said
from btlang.ros.server_goal import ServerGoal

_MOVED = 0.5  # metres
_AGAIN = 2.0  # seconds between two goals


class Pursuit:
    """See `btlang.robots.capabilities.Operation`. `set_out` sends a goal for where it was seen last; another one is
    sent when it is seen elsewhere. Raises what `set_out` does.
    """

    def __init__(self, name: str, sight: Sight, set_out: Callable[[], ServerGoal], now: float) -> None:
        self.done = False
        self.failure: str | None = None
        self._name, self._sight, self._set_out = name, sight, set_out
        self._goal = set_out()
        self._since, self._target = now, self._where()

    def cancel(self) -> None:
        """Gives up. Does nothing when done."""
        self.end(f"the navigation to {said(self._name)} was cancelled")

    def end(self, failure: str | None) -> None:
        """There, or the reason why not. Does nothing when done."""
        if not self.done:
            self.done, self.failure = True, failure
            self._goal.end(failure)

    def step(self, now: float) -> None:
        """Goes on at a second of the run."""
        if self.done:
            return
        if self._goal.done:
            self.end(self._sight.lost(self._name) if self._goal.failure is None else self._goal.failure)
        elif now - self._since >= _AGAIN and dist(self._where(), self._target) > _MOVED:
            try:
                self._goal = self._set_out()
            except RobotError as error:
                self.end(str(error))
            self._since, self._target = now, self._where()

    def _where(self) -> Point:
        return self._sight.where(self._name) or self._target

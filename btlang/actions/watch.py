"""What every action that moves the robot looks out for."""

from __future__ import annotations

from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import Robot


class Watch:
    """Notices bumps, emergency stops and the like that happen after it was made."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._bumps = robot.bumps
        self._stops = robot.stops

    def check_stop(self) -> None:
        """Raises ActionFailed when somebody has stopped the robot."""
        if self._robot.stops != self._stops:
            raise ActionFailed("the robot was stopped")

    def check_base(self, so_far: str) -> None:
        """Raises ActionFailed when the base cannot go on; `so_far` says how far it got: "0.31 m"."""
        self.check_stop()
        if self._robot.bumps != self._bumps:
            raise ActionFailed(f"bumped into something after {so_far}")
        if self._robot.battery_empty:
            raise ActionFailed(f"the battery is empty after {so_far}")
        if self._robot.stuck:
            raise ActionFailed(f"stuck after {so_far}: the wheels turn but the robot doesn't move")

"""What every action that moves the robot looks out for."""

from __future__ import annotations

from collections.abc import Generator
from typing import Protocol

from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import Base, Machine, Power, Sensors

STUCK = "the wheels turn but the robot doesn't move"


class Driving(Base, Sensors, Power, Protocol):
    """A base that says what keeps it from driving on, as far as it has a bumper and a battery."""


class Watch:
    """Notices emergency stops that happen after it was made."""

    def __init__(self, robot: Machine) -> None:
        self._machine = robot
        self._stops = robot.stops

    def check_stop(self) -> None:
        """Raises ActionFailed when somebody has stopped the robot."""
        if self._machine.stops != self._stops:
            raise ActionFailed("the robot was stopped")

    def pause(self, seconds: float) -> Generator[None, None, None]:
        """Waits. Raises as `check_stop`."""
        until = self._machine.time + seconds
        while self._machine.time < until:
            yield
            self.check_stop()


class BaseWatch(Watch):
    """Notices bumps and the like, too."""

    def __init__(self, robot: Driving) -> None:
        super().__init__(robot)
        self._robot = robot
        self._bumps = robot.bumps

    def check_base(self, so_far: str) -> None:
        """Raises ActionFailed when the base cannot go on; `so_far` says how far it got: "0.31 m"."""
        self.check_stop()
        if self._robot.bumps != self._bumps:
            raise ActionFailed(f"bumped into something after {so_far}")
        if self._robot.battery_empty:
            raise ActionFailed(f"the battery is empty after {so_far}")
        reason = self._robot.held_back
        if self._robot.stuck:
            raise ActionFailed(f"stuck after {so_far}: {reason or STUCK}")
        if reason:
            raise ActionFailed(f"stopped after {so_far}: {reason}")

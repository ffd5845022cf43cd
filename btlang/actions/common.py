"""What actions share: what moving actions look out for, the pace, and the places and things that texts mean."""

from __future__ import annotations

from collections.abc import Generator
from typing import Protocol

from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point
from btlang.robots.robot import Base, Listening, Machine, Navigation, Perception, Power, RobotError, Sensors

_SHARES = {"slowly": 0.5, "carefully": 0.5, "quietly": 0.4}
"""Shares of the normal speed. "Quickly" is as fast as the robot can."""
COUNTABLE = ("object", "person")
"""The types of things that have a kind and can be seen."""
STUCK = "the wheels turn but the robot doesn't move"


class MeetingRobot(Perception, Listening, Navigation, Protocol):
    """A robot that goes to people whom it sees or hears."""


def speaker(robot: MeetingRobot) -> str | None:
    """Return who "me" is: the last speaker, else the nearest person in view; None if there is nobody."""
    heard = robot.ears.since(0) if robot.body.has("ears") else []
    spoken = next((each.who for each in reversed(heard) if each.who), None)
    return spoken or next(iter(robot.seen("person")), None)


def where(robot: Base, place: str | None, x: float | None, y: float | None) -> Point:
    """Return the metres on the map. Raises RobotError for an unknown place, and without a place and a point."""
    if place is not None:
        return robot.locate(place)
    if x is None or y is None:
        raise RobotError("neither a place nor a point is given")
    return x, y


def spot(x: float | None, y: float | None) -> str:
    """Return the name of a point in messages."""
    return f"({x}, {y})"


def things_described(robot: Base, type: str, **parts: str) -> list[str]:
    """Return the names of the known things of type "object" or "person" with these parts, nearest first.

    The parts are `kind`, `color` and `use` of objects, `clothing`, `color` and `gesture` of people; "" is any.
    """
    return robot.described(type, {name: text for name, text in parts.items() if text})


def of_a_kind(robot: Base, kind: str, **parts: str) -> list[str]:
    """Return the names of the known objects and people of a kind with these parts."""
    return [name for type in COUNTABLE for name in things_described(robot, type, kind=kind, **parts)]


def keep_pace(robot: Base, manner: str | None, steps: Generator[None, None, None]) -> Generator[None, None, None]:
    """Do the steps in this manner, without one at the current pace; when halted, halt them."""
    if manner is None:
        yield from steps
        return
    before, robot.pace = robot.pace, share_of(robot, manner)
    try:
        yield from steps
    finally:
        robot.pace = before


def share_of(robot: Base, manner: str | None) -> float:
    """Return the share of the normal speed; 1 without a manner."""
    return 1.0 if manner is None else _SHARES.get(manner, robot.max_speed / robot.normal_speed)


class DrivingRobot(Base, Sensors, Power, Protocol):
    """A base that reports what keeps it from driving on, as far as it has a bumper and a battery."""


class Watch:
    """A watch for emergency stops that happen after it was made."""

    def __init__(self, robot: Machine) -> None:
        self._machine = robot
        self._stops = robot.stops

    def check_stop(self) -> None:
        """Raise ActionFailed if somebody has stopped the robot."""
        if self._machine.stops != self._stops:
            raise ActionFailed("the robot was stopped")

    def pause(self, seconds: float) -> Generator[None, None, None]:
        """Wait. Raises as `check_stop`."""
        until = self._machine.time + seconds
        while self._machine.time < until:
            yield
            self.check_stop()


class BaseWatch(Watch):
    """A watch for bumps and other trouble of the base, too."""

    def __init__(self, robot: DrivingRobot) -> None:
        super().__init__(robot)
        self._robot = robot
        self._bumps = robot.bumps

    def check_base(self, so_far: str) -> None:
        """Raise ActionFailed if the base can't go on; `so_far` is how far it got: "0.31 m"."""
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


def compares(
    found: float,
    below: float | None,
    above: float | None,
    at_least: float | None,
    at_most: float | None,
    equal: float | None,
) -> bool:
    """Return whether a number is as each of these limits says (None is none); without any, whether it is above 0."""
    if (below, above, at_least, at_most, equal) == (None,) * 5:
        return found > 0
    return (
        (below is None or found < below)
        and (above is None or found > above)
        and (at_least is None or found >= at_least)
        and (at_most is None or found <= at_most)
        and (equal is None or found == equal)
    )

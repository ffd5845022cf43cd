"""What a robot senses at one time, read once for all who watch."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import isfinite

from btlang.engine.leaves.leaf import ActionFailed
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


Whereabouts = tuple[str, float | None, float | None, bool]
"""The name of a person or an object, x and y in metres, None where it isn't there, and whether the robot sees it."""


class RobotState(Record):
    """The state of a robot: pose, percent of the battery, and what the hands hold; None for what the robot does not
    know.

    `things` are those that are or may be elsewhere than the map of the world has them.
    """

    pose: Any = None
    battery: float | None = None
    left: str | None = None
    right: str | None = None
    things: tuple[Whereabouts, ...] = ()

    @property
    def place(self) -> list[float] | None:
        """The pose in metres and degrees for those who watch: rounded, so that a robot at rest has nothing new."""
        pose = self.pose
        return None if pose is None else [round(pose.x, 3), round(pose.y, 3), round(pose.heading, 1)]

    @property
    def charge(self) -> float | None:
        """The percent of the battery, rounded likewise."""
        return None if self.battery is None else round(self.battery, 1)


class Movements:
    """A memory of whereabouts, so that those who keep or send them need only what has changed."""

    def __init__(self) -> None:
        self._known: dict[str, Whereabouts] = {}

    def changed(self, things: Iterable[Whereabouts]) -> list[Whereabouts]:
        """Return the whereabouts that are not as they were at the last call."""
        found = [each for each in things if self._known.get(each[0]) != each]
        self._known.update((each[0], each) for each in found)
        return found


def read_robot(robot: Any) -> RobotState | None:
    """Return the state of a robot, None where there is no robot. For the thread of the run."""
    if robot is None:
        return None
    hands = (ask_sensor(lambda: robot.holding("left")), ask_sensor(lambda: robot.holding("right")))
    things = ask_sensor(lambda: robot.things) or ()
    return RobotState(ask_sensor(lambda: robot.pose), ask_sensor(lambda: robot.battery), *hands, things)


def ask_sensor(ask: Callable[[], Any]) -> Any:
    """Return what a sensor says; None where the robot has no such one, or it is silent."""
    try:
        return ask()
    except (ActionFailed, AttributeError):
        return None


def round_scan(ranges: Iterable[float]) -> list[float | None]:
    """Round metres for those who watch, counter-clockwise from straight ahead; None where nothing is."""
    return [round(distance, 2) if isfinite(distance) else None for distance in ranges]

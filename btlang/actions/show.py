"""For an audience: bowing and dancing."""

from __future__ import annotations

from typing import Protocol

from btlang.actions.joints import take
from btlang.actions.motion import Steps, turn
from btlang.actions.watch import Driving, Watch
from btlang.robots.capabilities import Joints

_BOWED, _SWING = 1.0, 45.0  # seconds, degrees


class Dancing(Joints, Driving, Protocol):
    """Arms on a base that turns."""


def bow(robot: Joints) -> Steps:
    """Lowers the head for a second."""
    yield from take(robot, "look down")
    watch, until = Watch(robot), robot.time + _BOWED
    while robot.time < until:
        yield
        watch.check_stop()
    yield from take(robot, "look ahead")


def dance(robot: Dancing) -> Steps:
    """Swings from side to side on the spot, and raises one arm after the other."""
    for side, arm in ((1.0, "left arm"), (-1.0, "right arm")):
        yield from take(robot, f"{arm} raised")
        yield from turn(robot, side * _SWING)
        yield from turn(robot, side * -2.0 * _SWING)
        yield from turn(robot, side * _SWING)
        yield from take(robot, f"{arm} hanging")

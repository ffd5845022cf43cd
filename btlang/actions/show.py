"""For an audience: bowing and dancing."""

from __future__ import annotations

from btlang.actions.joints import take
from btlang.actions.motion import Steps, turn
from btlang.actions.watch import Driving, Watch
from btlang.robots.robot import Joints

_BOWED = 1.0  # seconds


def bow(robot: Joints) -> Steps:
    """Lowers the head for a second."""
    yield from take(robot, "look down")
    yield from Watch(robot).pause(_BOWED)
    yield from take(robot, "look ahead")


def dance(robot: Driving) -> Steps:
    """Swings from side to side on the spot, and turns once around."""
    for angle in (45.0, -90.0, 90.0, -45.0, 360.0):
        yield from turn(robot, angle)

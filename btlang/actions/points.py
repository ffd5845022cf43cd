"""Where a place is, or a point that stands in its place."""

from __future__ import annotations

from btlang.robots.geometry import Point
from btlang.robots.robot import Base, RobotError


def where(robot: Base, place: str | None, x: float | None, y: float | None) -> Point:
    """Metres on the map. Raises RobotError for an unknown place, and where neither it nor a point is given."""
    if place is not None:
        return robot.locate(place)
    if x is None or y is None:
        raise RobotError("neither a place nor a point is given")
    return x, y


def spot(x: float | None, y: float | None) -> str:
    """What a point is called in messages."""
    return f"({x}, {y})"

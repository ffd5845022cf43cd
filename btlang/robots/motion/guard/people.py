"""How fast it is safe to drive where people walk: the robot stands before somebody who comes nearer has reached it."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, hypot, inf, radians, sqrt
from typing import Protocol

from btlang.robots.geometry import Point, Pose

_MARGIN = 0.08  # metres that stay free
_APPROACH = 0.6  # metres a second at which people may come nearer while it brakes; they look where they go
_DELAY = 0.05  # seconds until it brakes
_AHEAD = cos(radians(75.0))
_LOOK = 2.0  # metres


class WalkingPeople(Protocol):
    """Those who walk, as far as the robot knows."""

    @property
    def walking(self) -> Mapping[str, tuple[float, float, float]]:
        """x, y and radius by their names, on the map."""

    def wall_between(self, a: Point, b: Point) -> bool:
        """True when a wall crosses the straight line from a to b."""


def safe_among(people: WalkingPeople, pose: Pose, backward: bool, radius: float, brake: float) -> tuple[float, str]:
    """Metres a second that are safe for a robot of a radius which can brake so, and who limits it; inf and "" where
    nobody does."""
    heading = radians(pose.heading + 180.0 * backward)
    ahead = cos(heading), cos(heading - radians(90.0))
    most, who = inf, ""
    lost = _APPROACH + _DELAY * brake
    for name, (x, y, wide) in people.walking.items():
        dx, dy = x - pose.x, y - pose.y
        if abs(dx) > _LOOK or abs(dy) > _LOOK:
            continue
        distance = hypot(dx, dy)
        if dx * ahead[0] + dy * ahead[1] < _AHEAD * distance:
            continue
        gap = distance - wide - radius - _MARGIN
        safe = sqrt(lost * lost + 2 * brake * gap) - lost if gap > 0.0 else 0.0
        if safe < most and not people.wall_between((pose.x, pose.y), (x, y)):
            most, who = safe, name
    return most, who

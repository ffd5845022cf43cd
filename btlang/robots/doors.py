"""Where to stand to open or close a door."""

from __future__ import annotations

from math import hypot

from btlang.robots.geometry import Pose
from btlang.robots.world import Door

_BESIDE = 0.7  # metres from the middle of a door


def spots_beside(door: Door, pose: Pose) -> list[Pose]:
    """Before and behind a door, facing it; the one nearer to the pose first."""
    (ax, ay), (bx, by), (x, y) = door.start, door.end, door.middle
    length = max(hypot(bx - ax, by - ay), 1e-9)
    across = -(by - ay) / length * _BESIDE, (bx - ax) / length * _BESIDE
    spots = [(x + side * across[0], y + side * across[1]) for side in (1, -1)]
    spots.sort(key=pose.distance_to)
    return [Pose(*spot, Pose(*spot).bearing_to((x, y))) for spot in spots]

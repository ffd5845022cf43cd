"""The laser scanner: exact distances along 360 beams from the robot's centre."""

from __future__ import annotations

import numpy as np

from btlang.robots.geometry import Pose
from btlang.robots.obstacles import Array, Obstacles

RANGE = 8.0
_ANGLES = np.radians(np.arange(360.0))


class Scanner:
    """Computes a scan when it is first read from a pose, and keeps it until something moves."""

    def __init__(self, obstacles: Obstacles) -> None:
        self._obstacles = obstacles
        self._pose: Pose | None = None
        self._version = -1
        self._ranges: Array = np.empty(0)

    def read(self, pose: Pose) -> Array:
        """See `scan`."""
        if pose is not self._pose or self._version != self._obstacles.version:
            self._ranges = scan(self._obstacles, pose)
            self._pose, self._version = pose, self._obstacles.version
        return self._ranges


def scan(obstacles: Obstacles, pose: Pose) -> Array:
    """360 distances in metres, index = degrees left of the heading; inf beyond RANGE."""
    angles = _ANGLES + np.radians(pose.heading)
    beams = np.stack((np.cos(angles), np.sin(angles)))
    ranges = np.full(360, np.inf)
    if len(obstacles.starts):
        ranges = np.minimum(ranges, _to_segments(obstacles, pose, beams))
    if len(obstacles.discs):
        ranges = np.minimum(ranges, _to_discs(obstacles.discs, pose, beams))
    ranges[ranges > RANGE] = np.inf
    ranges.flags.writeable = False  # shared by all who read it between two steps
    return ranges


def _to_segments(obstacles: Obstacles, pose: Pose, beams: Array) -> Array:
    """Solves centre + t * beam = start + u * span for every span (rows) and beam (columns), with few temporaries."""
    fx, fy = obstacles.starts[:, 0] - pose.x, obstacles.starts[:, 1] - pose.y
    dx, dy = obstacles.spans[:, 0], obstacles.spans[:, 1]
    cross = np.stack((dy, -dx), axis=1) @ beams
    u = np.stack((-fy, fx), axis=1) @ beams
    with np.errstate(all="ignore"):
        u /= cross
        t = np.divide((fx * dy - fy * dx)[:, None], cross, out=cross)
    t[~((t >= 0.0) & (u >= -1e-9) & (u <= 1.0 + 1e-9))] = np.inf
    nearest: Array = t.min(axis=0)
    return nearest


def _to_discs(discs: Array, pose: Pose, beams: Array) -> Array:
    fx, fy, radius = discs[:, 0] - pose.x, discs[:, 1] - pose.y, discs[:, 2:]
    along = np.stack((fx, fy), axis=1) @ beams
    half2 = radius**2 - (np.stack((-fy, fx), axis=1) @ beams) ** 2
    t = along - np.sqrt(np.maximum(half2, 0.0))
    nearest: Array = np.where((half2 >= 0.0) & (t >= 0.0), t, np.inf).min(axis=0)
    return nearest

"""The laser scanner: exact distances along 360 beams from the robot's centre."""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, atan2, ceil, cos, degrees, floor, hypot, inf, radians, sin, sqrt

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import CENTRE, Pose, Segment
from btlang.robots.worlds.obstacles import Disc, Obstacles

Array = npt.NDArray[np.float64]

_DEGREES = np.radians(np.arange(360.0))


class Scanner:
    """A scanner that computes a scan when it is first read from a pose, and keeps it until something moves."""

    def __init__(self, obstacles: Obstacles, reach: float) -> None:
        self._reach = reach
        self._obstacles = obstacles
        self._segments: Array = np.empty(0)
        self._walls = -1
        self._pose: Pose | None = None
        self._version = -1
        self._ranges: Array = np.empty(0)

    def read(self, pose: Pose) -> Array:
        if pose is not self._pose or self._version != self._obstacles.version:
            obstacles = self._obstacles
            if self._walls != obstacles.walls:
                self._segments = np.array(obstacles.segments, dtype=np.float64).reshape(-1, 4)
                self._walls = obstacles.walls
            discs = np.array((*obstacles.discs, *obstacles.walking.values()), dtype=np.float64).reshape(-1, 3)
            self._ranges = scan(self._segments, discs, pose, self._reach)
            self._pose, self._version = pose, self._obstacles.version
        return self._ranges


def scan(segments: Array, discs: Array, pose: Pose, reach: float) -> Array:
    """Return 360 distances in metres, index = degrees left of the heading; inf beyond `reach` metres.

    A row of `segments` is x, y of one end and of the other, a row of `discs` is x, y and radius.
    """
    if getattr(np, "is_stand_in", False):
        ranges = np.array(trace_beams(segments.tolist(), discs.tolist(), pose, reach))
        ranges.flags.writeable = False
        return ranges
    angles = _DEGREES + np.radians(pose.heading)
    beams = np.array((np.cos(angles), np.sin(angles)))
    ranges = np.full(360, np.inf)
    if len(segments):
        ranges = np.minimum(ranges, _to_segments(segments, pose, beams))
    if len(discs):
        ranges = np.minimum(ranges, _to_discs(discs, pose, beams))
    ranges[ranges > reach] = np.inf
    ranges.flags.writeable = False  # shared by all who read it between two steps
    return ranges


def trace_beams(segments: Sequence[Segment], discs: Sequence[Disc], pose: Pose, reach: float) -> list[float]:
    """Return what `scan` does, in plain Python: each segment and disc is only compared with the beams towards it."""
    ranges = [inf] * 360
    beams = [(cos(angle), sin(angle)) for angle in (radians(pose.heading + degree) for degree in range(360))]
    for ax, ay, bx, by in segments:
        fx, fy, dx, dy = ax - pose.x, ay - pose.y, bx - ax, by - ay
        crossed = fx * dy - fy * dx
        first = degrees(atan2(fy, fx)) - pose.heading
        turn = (degrees(atan2(by - pose.y, bx - pose.x)) - pose.heading - first + 180.0) % 360.0 - 180.0
        low, high = floor(min(first, first + turn)) - 1, ceil(max(first, first + turn)) + 2
        if high - low > 178:  # it's so near that rounding decides on which side it passes
            low, high = 0, 360
        for degree in range(low, high):
            x, y = beams[degree % 360]
            across = x * dy - y * dx
            if across:
                far, along = crossed / across, (y * fx - x * fy) / across
                if 0.0 <= far < ranges[degree % 360] and -1e-9 <= along <= 1.0 + 1e-9:
                    ranges[degree % 360] = far
    for cx, cy, radius in discs:
        fx, fy = cx - pose.x, cy - pose.y
        away = hypot(fx, fy)
        wide = degrees(asin(radius / away)) if away > radius else 180.0
        middle = degrees(atan2(fy, fx)) - pose.heading
        for degree in range(floor(middle - wide), ceil(middle + wide) + 1):
            x, y = beams[degree % 360]
            along, beside = x * fx + y * fy, x * fy - y * fx
            if abs(beside) <= radius:
                far = along - sqrt(radius * radius - beside * beside)
                if 0.0 <= far < ranges[degree % 360]:
                    ranges[degree % 360] = far
    return [far if far <= reach else inf for far in ranges]


def around(ranges: Array, angles: Array, at: Pose, step: float = 1.0) -> Array:
    """Return 360 distances from a robot's centre, index = degrees left of its heading; NaN if no valid beam looked.

    `ranges` are metres that a scanner measured, inf if nothing was in range, NaN for a beam without a measurement, at
    `angles` in radians left of its own front; two neighbours are `step` degrees apart. `at` is its pose as seen from
    the centre.
    """
    found = np.full(360, np.nan)
    valid = ~np.isnan(ranges)
    found[_covered_degrees(angles[valid] + np.radians(at.heading), step)] = np.inf
    seen = np.isfinite(ranges)
    ranges, angles = ranges[seen], angles[seen] + np.radians(at.heading)
    if at.x or at.y:
        x, y = at.x + ranges * np.cos(angles), at.y + ranges * np.sin(angles)
        ranges, angles = np.hypot(x, y), np.arctan2(y, x)
    np.fmin.at(found, np.rint(np.degrees(angles)).astype(int) % 360, ranges)
    found.flags.writeable = False
    return found


def _covered_degrees(angles: Array, step: float) -> npt.NDArray[np.int64]:
    """Return the degrees that are covered by beams so many degrees apart."""
    half = min(180, max(0, round(step / 2)))
    middles = np.rint(np.degrees(angles)).astype(int)
    covered: npt.NDArray[np.int64] = (middles[:, None] + np.arange(-half, half + 1)).ravel() % 360
    return covered


def summary(ranges: Array, radius: float) -> tuple[float, float]:
    """Return the metres that are free around a robot's rim, -inf if a beam is missing, and a number that changes with
    the ranges.
    """
    room = -inf if np.isnan(ranges).any() else float(ranges.min()) - radius
    return room, float(ranges[np.isfinite(ranges)].sum())


def as_measured(ranges: Array, at: Pose) -> Array:
    """Return a scan around the robot's centre as a scanner at this pose of the robot measures it."""
    if at == CENTRE:
        return ranges
    measured = around(ranges, _DEGREES, at.inverse)
    return np.where(
        np.isnan(measured), np.inf, measured
    )  # what is nearer hides no degree from a beam that starts elsewhere


def _to_segments(segments: Array, pose: Pose, beams: Array) -> Array:
    """Solve centre + t * beam = start + u * span for every span (rows) and beam (columns), with few temporaries."""
    fx, fy = segments[:, 0] - pose.x, segments[:, 1] - pose.y
    dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]
    cross = np.array((dy, -dx)).T @ beams
    u = np.array((-fy, fx)).T @ beams
    with np.errstate(all="ignore"):
        u /= cross
        t = np.divide((fx * dy - fy * dx)[:, None], cross, out=cross)
    t[~((t >= 0.0) & (u >= -1e-9) & (u <= 1.0 + 1e-9))] = np.inf
    nearest: Array = t.min(axis=0)
    return nearest


def _to_discs(discs: Array, pose: Pose, beams: Array) -> Array:
    fx, fy, radius = discs[:, 0] - pose.x, discs[:, 1] - pose.y, discs[:, 2:]
    along = np.array((fx, fy)).T @ beams
    half2 = radius**2 - (np.array((-fy, fx)).T @ beams) ** 2
    t = along - np.sqrt(np.maximum(half2, 0.0))
    nearest: Array = np.where((half2 >= 0.0) & (t >= 0.0), t, np.inf).min(axis=0)
    return nearest

"""How far the links of a body are from each other, for many configurations at once."""

from __future__ import annotations

from math import dist

import numpy as np

from btlang.robots.body import Body
from btlang.robots.motion.kinematics import Array, Kinematics

_TINY = 1e-12


class Collisions:
    """Between the forbidden pairs of a body."""

    def __init__(self, body: Body, kinematics: Kinematics) -> None:
        self._kinematics, self._capsules = kinematics, body.capsules
        of_link: dict[str, list[int]] = {}
        for index, capsule in enumerate(body.capsules):
            of_link.setdefault(capsule.link, []).append(index)
        pairs = [
            (number, one, other)
            for number, (first, second) in enumerate(body.forbidden)
            for one in of_link.get(first, ())
            for other in of_link.get(second, ())
        ]
        self.pairs = [body.forbidden[number] for number, *_ in pairs]
        """Two links for each row of `distances`; links that have several capsules are in several."""
        self._first = [one for _, one, _ in pairs]
        self._second = [other for *_, other in pairs]
        sizes = [(capsule.radius, dist(capsule.start, capsule.end) / 2) for capsule in body.capsules]
        self._radii = [sizes[one][0] + sizes[other][0] for _, one, other in pairs]
        self._reach = [sum(sizes[one]) + sum(sizes[other]) for _, one, other in pairs]

    def distances(self, configurations: Array, within: float = np.inf) -> Array:
        """Metres between two capsules, a row for each of `pairs`, a column for each configuration; below 0 inside.

        What is further than `within` may be inf.
        """
        found = np.full((len(self.pairs), len(configurations)), np.inf)
        if not self.pairs:
            return found
        frames = self._kinematics.frames(configurations)
        starts = np.stack([frames[capsule.link].place(capsule.start) for capsule in self._capsules])
        ways = np.stack([frames[capsule.link].place(capsule.end) for capsule in self._capsules]) - starts
        middles = starts + ways / 2
        for row, (one, other) in enumerate(zip(self._first, self._second, strict=True)):
            apart = middles[one] - middles[other]
            near = np.flatnonzero(_dot(apart, apart) <= (within + self._reach[row]) ** 2)
            if len(near):
                segments = (points[:, near] for points in (starts[one], ways[one], starts[other], ways[other]))
                found[row, near] = segment_distances(*segments) - self._radii[row]
        return found


def segment_distances(start: Array, along: Array, other_start: Array, other: Array) -> Array:
    """Metres between two line segments from a start along a way, for arrays of points whose first axis is x, y, z."""
    between = start - other_start
    a, e = _dot(along, along), _dot(other, other)
    b, c, f = _dot(along, other), _dot(along, between), _dot(other, between)
    slant = a * e - b * b
    s = np.where(slant > _TINY, np.clip((b * f - c * e) / np.maximum(slant, _TINY), 0.0, 1.0), 0.0)
    t = np.where(e > _TINY, np.clip((b * s + f) / np.maximum(e, _TINY), 0.0, 1.0), 0.0)
    s = np.where(a > _TINY, np.clip((b * t - c) / np.maximum(a, _TINY), 0.0, 1.0), 0.0)
    apart = between + along * s - other * t
    found: Array = np.sqrt(_dot(apart, apart))
    return found


def _dot(one: Array, other: Array) -> Array:
    found: Array = one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
    return found

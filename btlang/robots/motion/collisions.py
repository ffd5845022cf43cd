"""How far the links of a body are from each other, for many configurations at once."""

from __future__ import annotations

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
        radii = np.array([capsule.radius for capsule in body.capsules])
        self._radii = radii[self._first] + radii[self._second] if pairs else np.zeros(0)

    def distances(self, configurations: Array) -> Array:
        """Metres between two capsules, a row for each of `pairs`, a column for each configuration; below 0 inside."""
        if not self.pairs:
            return np.zeros((0, len(configurations)))
        frames = self._kinematics.frames(configurations)
        starts = np.stack([frames[capsule.link].place(capsule.start) for capsule in self._capsules])
        ends = np.stack([frames[capsule.link].place(capsule.end) for capsule in self._capsules])
        one, other = self._first, self._second
        return segment_distances(starts[one], ends[one], starts[other], ends[other]) - self._radii[:, None]


def segment_distances(start: Array, end: Array, other_start: Array, other_end: Array) -> Array:
    """Metres between two line segments, for arrays of points whose last axis is x, y, z."""
    along, other, between = end - start, other_end - other_start, start - other_start
    a, e = _dot(along, along), _dot(other, other)
    b, c, f = _dot(along, other), _dot(along, between), _dot(other, between)
    slant = a * e - b * b
    s = np.where(slant > _TINY, np.clip((b * f - c * e) / np.maximum(slant, _TINY), 0.0, 1.0), 0.0)
    t = np.where(e > _TINY, (b * s + f) / np.maximum(e, _TINY), 0.0)
    t = np.clip(t, 0.0, 1.0)
    s = np.where(a > _TINY, np.clip((b * t - c) / np.maximum(a, _TINY), 0.0, 1.0), 0.0)
    apart = between + along * s[..., None] - other * t[..., None]
    found: Array = np.sqrt(_dot(apart, apart))
    return found


def _dot(one: Array, other: Array) -> Array:
    found: Array = np.einsum("...k,...k->...", one, other)
    return found

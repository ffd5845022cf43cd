"""Where the links of a body are, how far apart they are, and which joint angles point at something."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import dist

import numpy as np
import numpy.typing as npt

from btlang.robots.bodies.body import Body, Joint, Vector
from btlang.support.record import Record

Array = npt.NDArray[np.float64]
_TINY = 1e-12
_ROUNDS = 60
_NUDGE = 0.01  # degrees or metres, for slopes
_DAMPING = 0.02
_SHOULDER = 0.05  # metres around the first joint
_MOST = 15.0  # degrees in a round
_STRAIGHT = 0.02  # sine of the angle between where it points and where it should


class LinkFrames(Record):
    """One link in n configurations, in the frame of the base.

    `turned[:, :, k]` are rotation matrices, and `origin[:, k]` its origins.
    """

    turned: Array
    origin: Array

    def place(self, point: Vector) -> Array:
        """Return a point of the link, three rows of n."""
        placed: Array = np.matmul(np.array(point, dtype=np.float64), self.turned) + self.origin
        return placed


class Kinematics:
    """The kinematics of a body. A configuration has the positions of its joints in their order and units."""

    def __init__(self, body: Body) -> None:
        self._joints: list[tuple[int, Joint, Array, Array]] = []
        by_link = {joint.link: (index, joint) for index, joint in enumerate(body.joints) if joint.link}
        for index, joint in _parents_first(by_link):
            x, y, z = joint.axis
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            self._joints.append((index, joint, cross.T, (cross @ cross).T))

    def frames(self, configurations: Array) -> Mapping[str, LinkFrames]:
        """Return the links by name, the base as "", for an array of n configurations."""
        n = len(configurations)
        found = {"": LinkFrames(np.repeat(np.eye(3)[:, :, None], n, axis=2), np.zeros((3, n)))}
        for index, joint, cross, squared in self._joints:
            parent, moved = found[joint.parent], configurations[:, index] * joint.si
            turned, origin = parent.turned, parent.place(joint.at)
            if joint.slides:
                origin = origin + np.matmul(np.array(joint.axis), turned) * moved
            else:
                turned = turned + np.sin(moved) * np.matmul(cross, turned)
                turned += (1.0 - np.cos(moved)) * np.matmul(squared, parent.turned)
            found[joint.link] = LinkFrames(turned, origin)
        return found


def _parents_first(by_link: Mapping[str, tuple[int, Joint]]) -> Sequence[tuple[int, Joint]]:
    ordered: dict[str, tuple[int, Joint]] = {}
    for link in by_link:
        chain = []
        while link and link not in ordered and link not in chain:
            chain.append(link)
            link = by_link[link][1].parent
        ordered.update((each, by_link[each]) for each in reversed(chain))
    return list(ordered.values())


class Collisions:
    """The distances between the forbidden pairs of a body."""

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
        """Two links for each row of `distances`; links with several capsules are in several rows."""
        self._first = [one for _, one, _ in pairs]
        self._second = [other for *_, other in pairs]
        sizes = [(capsule.radius, dist(capsule.start, capsule.end) / 2) for capsule in body.capsules]
        self._radii = [sizes[one][0] + sizes[other][0] for _, one, other in pairs]
        self._reach = [sum(sizes[one]) + sum(sizes[other]) for _, one, other in pairs]

    def distances(self, configurations: Array, within: float = np.inf) -> Array:
        """Return the metres between two capsules, a row for each of `pairs`, a column for each configuration.

        Below 0 they overlap. A distance beyond `within` may be inf.
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
    """Return the metres between two line segments from a start along a direction, for arrays of points.

    The first axis of the arrays is x, y, z.
    """
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


class AimSolver:
    """Joint angles that point parts of a body at something.

    The part with the camera looks ahead; any other points from its first joint to its end, and only the joints at the
    shoulder move for that.
    """

    def __init__(self, body: Body, kinematics: Kinematics) -> None:
        self._body, self._kinematics = body, kinematics

    def joints(self, part: str) -> list[int]:
        """Return the numbers of the joints of a part that aim it."""
        found = [index for index, joint in enumerate(self._body.joints) if joint.part == part and joint.link]
        if not found or self._looks(part):
            return found
        rest = self._kinematics.frames(np.array([[joint.rest for joint in self._body.joints]]))
        links = [self._body.joints[index].link for index in found]
        apart = [np.linalg.norm(rest[link].origin - rest[links[0]].origin) for link in links]
        return [index for index, metres in zip(found, apart, strict=True) if metres < _SHOULDER]

    def _looks(self, part: str) -> bool:
        camera = self._body.sensor("camera")
        seeing = self._body.joint(camera.joint) if camera is not None else None
        return seeing is not None and seeing.part == part

    def angles(self, part: str, at: Array, aim: Vector) -> dict[str, float] | None:
        """Return the angles by joint that point a part at a point in the frame of the base; None if it can't.

        The search starts where the joints are `at`.
        """
        joints = self.joints(part)
        if not joints:
            return None
        low = np.array([self._body.joints[index].low for index in joints])
        high = np.array([self._body.joints[index].high for index in joints])
        for begin in (at[joints], np.clip(np.zeros(len(joints)), low, high), (low + high) / 2):
            found = at.copy()
            found[joints] = begin
            for _ in range(_ROUNDS):
                tries = np.repeat(found[None], len(joints) + 1, axis=0)
                tries[np.arange(1, len(joints) + 1), joints] += _NUDGE
                wrong = self._wrong(part, tries, aim)
                if np.linalg.norm(wrong[0]) < _STRAIGHT / 10:
                    break
                slopes = (wrong[1:] - wrong[0]).T / _NUDGE
                damped = slopes @ slopes.T + (_DAMPING * np.linalg.norm(slopes)) ** 2 * np.eye(3)
                way = -slopes.T @ np.linalg.solve(damped, wrong[0])
                found[joints] = np.clip(found[joints] + np.clip(way, -_MOST, _MOST), low, high)
            if np.linalg.norm(self._wrong(part, found[None], aim)[0]) < _STRAIGHT:
                return {self._body.joints[index].name: float(found[index]) for index in joints}
        return None

    def _wrong(self, part: str, configurations: Array, aim: Vector) -> Array:
        """Return the difference between the current and the wanted direction, both of length 1."""
        frames = self._kinematics.frames(configurations)
        moving = [joint for joint in self._body.joints if joint.part == part and joint.link]
        first, last = moving[0], moving[-1]
        if self._looks(part):
            begin = frames[last.link].origin.T
            points: Array = frames[last.link].turned[:, 0].T
        else:
            begin = frames[first.link].origin.T
            points = _unit(frames[last.link].place(self._tip(last.link)).T - begin)
        return points - _unit(np.asarray(aim) - begin)

    def _tip(self, link: str) -> Vector:
        ends = [end for capsule in self._body.capsules if capsule.link == link for end in (capsule.start, capsule.end)]
        return max(ends, key=lambda end: sum(value * value for value in end), default=(1.0, 0.0, 0.0))


def _unit(vectors: Array) -> Array:
    found: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
    return found

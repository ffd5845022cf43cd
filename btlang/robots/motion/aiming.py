"""Where the joints of a part have to be so that it points at something."""

from __future__ import annotations

import numpy as np

from btlang.robots.body import Body, Vector
from btlang.robots.motion.kinematics import Array, Kinematics

_ROUNDS = 60
_NUDGE = 0.01  # degrees or metres, for slopes
_DAMPING = 0.02
_SHOULDER = 0.05  # metres around the first joint
_MOST = 15.0  # degrees in a round
_STRAIGHT = 0.02  # sine of the angle between where it points and where it should


class Aiming:
    """Of a body. A part that carries the camera looks ahead; any other points from its first joint to its end, and only
    the joints at the shoulder change for that.
    """

    def __init__(self, body: Body, kinematics: Kinematics) -> None:
        self._body, self._kinematics = body, kinematics

    def joints(self, part: str) -> list[int]:
        """The numbers of those of a part that aim it."""
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
        """By joint, those with which it points at a point of the frame of the base, from where the joints are `at`.

        None where it can't.
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
        """Where it points, less where it should: directions of length 1."""
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

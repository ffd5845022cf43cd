"""Whether a body may go its way: within all limits, without touching itself, and so that it can always be halted."""

from __future__ import annotations

import numpy as np

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.joint_tables import BASE
from btlang.robots.motion.course import PERIOD, JointLimits, MotionState, brake
from btlang.robots.motion.kinematics import Array, Collisions, Kinematics

_MARGIN = 0.01  # metres that are kept between links: more than they can get nearer between two looks
_EACH = 2  # samples between two looks at the way
_BRAKING = 0.04  # seconds between two looks at the way to rest
_AT_ONCE = 1024  # configurations, whose arrays fit into the cache of a processor
_ROUNDING = 1e-6
_JERK = 1.02  # of the limit, for differences of sampled accelerations


class TrajectoryCheck:
    """A check of the planned movements of one body."""

    def __init__(self, body: Body, kinematics: Kinematics) -> None:
        self._body = body
        self._limits = JointLimits.of(body.joints)
        self._collisions = Collisions(body, kinematics)

    def problem(self, way: MotionState, joints: list[int]) -> str:
        """Return why the body may not do a movement, "" if it may.

        The movement samples all joints; it is new for `joints`.
        """
        return self._beyond(way.of(joints), joints) or self._touching(way)

    def _beyond(self, way: MotionState, joints: list[int]) -> str:
        limits = self._limits.some(joints)
        coming = way.velocity + way.acceleration * np.abs(way.acceleration) / (2 * limits.jerk)
        jerk = np.abs(np.diff(way.acceleration, axis=0)) / PERIOD
        halts = brake(way, limits).end.position
        wide = _ROUNDING * (limits.high - limits.low)
        begins = np.minimum(way.position[0], halts[0]), np.maximum(way.position[0], halts[0])  # somebody moved it there
        low, high = np.minimum(limits.low, begins[0]) - wide, np.maximum(limits.high, begins[1]) + wide
        wrong = {
            "would turn too far": ((way.position < low) | (way.position > high) | (halts < low) | (halts > high)).any(
                0
            ),
            "would be too fast": (np.abs(np.stack([way.velocity, coming])) > limits.speed * _JERK).any((0, 1)),
            "would be too forceful": (np.abs(way.acceleration) > limits.acceleration * _JERK).any(0),
            "would be too jerky": (jerk > limits.jerk * _JERK).any(0),
        }
        for says, found in wrong.items():
            if found.any():
                return f"the {self._body.joints[joints[int(np.argmax(found))]].name} {says}"
        return ""

    def _touching(self, way: MotionState) -> str:
        if not self._collisions.pairs:
            return ""
        looks = sorted({*range(0, len(way.position), _EACH), len(way.position) - 1})
        seen = way.rows(looks)
        now = self._collisions.distances(self._braking(seen, slice(0, 1)), _MARGIN)
        allowed = np.minimum(_MARGIN, now.min(axis=1)) - _ROUNDING
        moving = (np.abs(seen.velocity).max(axis=1) > 0.0) | (np.abs(seen.acceleration).max(axis=1) > 0.0)
        looked = np.concatenate([seen.position, self._braking(seen, moving)])
        for begin in range(0, len(looked), _AT_ONCE):
            found = self._collisions.distances(looked[begin : begin + _AT_ONCE], _MARGIN)
            short = (found - allowed[:, None]).min(axis=1)
            if short.min() < 0.0:
                first, second = self._collisions.pairs[int(np.argmin(short))]
                return f"the {first or BASE} would touch the {second or BASE}"
        return ""

    def _braking(self, way: MotionState, rows: slice | Array) -> Array:
        """Return the body's positions on its way to rest from these samples."""
        halt = brake(way.rows(rows), self._limits)
        times = np.append(np.arange(_BRAKING, halt.seconds, _BRAKING), halt.seconds)
        return np.concatenate([halt.at(float(time)).position for time in times])

"""Movements as functions of time, what is sampled of them, and the quickest way to rest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil

import numpy as np
import numpy.typing as npt

from btlang.robots.bodies.body import Joint
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


PERIOD = 0.01
"""Seconds between two samples."""
_EXACT = 1e-9
_TINY = 1e-9


class MotionState(Record):
    """The positions, velocities and accelerations of some joints: of one moment, or a row for each sample."""

    position: Array
    velocity: Array
    acceleration: Array

    def of(self, joints: Sequence[int]) -> MotionState:
        """Return the state of some of the joints."""
        return MotionState(self.position[..., joints], self.velocity[..., joints], self.acceleration[..., joints])

    def rows(self, which: int | slice | Sequence[int] | npt.NDArray[Any]) -> MotionState:
        """Return some samples of many, in their order; for a number, one sample without that axis."""
        return MotionState(self.position[which], self.velocity[which], self.acceleration[which])


class JointLimits(Record):
    """The limits of some joints."""

    low: Array
    high: Array
    speed: Array
    acceleration: Array
    jerk: Array
    rest: Array

    @classmethod
    def of(cls, joints: Sequence[Joint]) -> JointLimits:
        """Return the limits of joints, in their order."""
        return cls(*(np.array([getattr(joint, name) for joint in joints]) for name in cls.fields))

    def some(self, joints: Sequence[int]) -> JointLimits:
        """Return the limits of some of them."""
        return JointLimits(*(getattr(self, name)[list(joints)] for name in self.fields))


class CourseSegment(Record):
    """A movement that lasts `seconds`; `at` returns the states at an array of times from its beginning."""

    seconds: float
    at: Callable[[Array], MotionState]


def samples(pieces: Sequence[CourseSegment]) -> MotionState:
    """Return the states of segments one after the other, every PERIOD; the last one is the end."""
    begins = np.cumsum([0.0, *(piece.seconds for piece in pieces)])
    times = PERIOD * np.arange(max(1, ceil(begins[-1] / PERIOD - _EXACT)) + 1)
    times = np.minimum(times, begins[-1])
    which = np.clip(np.searchsorted(begins, times, side="right") - 1, 0, len(pieces) - 1)
    found = [piece.at(times[which == index] - begins[index]) for index, piece in enumerate(pieces)]
    return MotionState(*(np.concatenate([getattr(state, name) for state in found]) for name in MotionState.fields))


def between(before: MotionState, after: MotionState, share: float) -> MotionState:
    """Return the state at a `share` (0 to 1) of a PERIOD after a sample: on the quintic to the next sample."""
    return quintic(before, after, PERIOD).at(np.array([share * PERIOD])).rows(0)


def quintic(start: MotionState, end: MotionState, seconds: float) -> CourseSegment:
    """Return the polynomial of degree five from one state to another."""
    return CourseSegment(seconds, lambda times: on_quintic(start, end, seconds, times))


def on_quintic(start: MotionState, end: MotionState, seconds: float | Array, times: Array) -> MotionState:
    """Return states on `quintic` at times from its beginning; with rows of states and a column of seconds, one for
    each.
    """
    h = seconds
    p, v, a = start.position, start.velocity * h, start.acceleration * h * h / 2
    way = end.position - p - v - a
    speed, force = end.velocity * h - v - 2 * a, end.acceleration * h * h - 2 * a
    c3, c4, c5 = 10 * way - 4 * speed + force / 2, -15 * way + 7 * speed - force, 6 * way - 3 * speed + force / 2
    t = np.clip(times[:, None] / h, 0.0, 1.0)
    position = p + t * (v + t * (a + t * (c3 + t * (c4 + t * c5))))
    velocity = (v + t * (2 * a + t * (3 * c3 + t * (4 * c4 + t * 5 * c5)))) / h
    return MotionState(position, velocity, (2 * a + t * (6 * c3 + t * (12 * c4 + t * 20 * c5))) / (h * h))


def to_state(start: MotionState, end: MotionState, limits: JointLimits, least: float = 0.0) -> CourseSegment | None:
    """Return the quickest movement between two states, in at least so many seconds; None if there is none."""
    import ruckig  # only bodies whose joints have an acceleration need it

    count = len(start.position)
    wanted, found = ruckig.InputParameter(count), ruckig.Trajectory(count)
    wanted.current_position, wanted.target_position = start.position.tolist(), end.position.tolist()
    wanted.current_velocity, wanted.target_velocity = start.velocity.tolist(), end.velocity.tolist()
    wanted.current_acceleration, wanted.target_acceleration = start.acceleration.tolist(), end.acceleration.tolist()
    wanted.max_velocity, wanted.max_jerk = limits.speed.tolist(), limits.jerk.tolist()
    wanted.max_acceleration = limits.acceleration.tolist()
    if least > 0.0:
        wanted.minimum_duration = least
    try:
        result = ruckig.Ruckig(count).calculate(wanted, found)
    except ruckig.RuckigError:
        return None
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        return None

    def at(times: Array) -> MotionState:
        states = [found.at_time(float(t)) for t in times]
        shape = (len(states), count)
        return MotionState(*(np.array([state[k] for state in states]).reshape(shape) for k in range(3)))

    return CourseSegment(float(found.duration), at)


class Brake(Record):
    """Three stretches of constant jerk from a state to rest, which take `first`, `second` and `third` seconds.

    The jerk of the first is `jerk`, and that of the third its opposite.
    """

    start: MotionState
    jerk: Array
    first: Array
    second: Array
    third: Array

    @property
    def seconds(self) -> float:
        """The seconds until all of them rest."""
        return float(np.max(self.first + self.second + self.third, initial=0.0))

    @property
    def end(self) -> MotionState:
        """The positions at rest."""
        return self.at(self.seconds)

    def at(self, seconds: float | Array) -> MotionState:
        """Return the states so many seconds later."""
        p, v, a = self.start.position, self.start.velocity, self.start.acceleration
        left = np.asarray(seconds, dtype=np.float64)
        for lasts, jerk in ((self.first, self.jerk), (self.second, 0.0), (self.third, -self.jerk)):
            t = np.clip(left, 0.0, lasts)
            p = p + t * (v + t * (a / 2 + t * jerk / 6))
            v = v + t * (a + t * jerk / 2)
            a = a + t * jerk
            left = left - t
        over = left > 0.0
        return MotionState(p, np.where(over, 0.0, v), np.where(over, 0.0, a))


def brake(state: MotionState, limits: JointLimits) -> Brake:
    """Plan the fastest stop from a state, or from each of many."""
    velocity, acceleration, jerk = state.velocity, state.acceleration, limits.jerk
    without = velocity + acceleration * np.abs(acceleration) / (2 * jerk)  # where it would be without more force
    sign = np.where(without < 0.0, -1.0, 1.0)
    v, a = sign * velocity, sign * acceleration
    peak = np.sqrt(np.maximum(jerk * v + a * a / 2, 0.0))
    capped = np.minimum(peak, np.maximum(limits.acceleration, -a))
    first = np.maximum((a + capped) / jerk, 0.0)
    rest = np.maximum(v + a * a / (2 * jerk) - capped * capped / jerk, 0.0)
    second = np.where(peak > capped, rest / np.maximum(capped, _TINY), 0.0)
    return Brake(state, -sign * jerk, first, second, capped / jerk)


def plan_brake(state: MotionState, limits: JointLimits) -> CourseSegment:
    """Plan the fastest stop from one state, as a segment."""
    found = brake(state, limits)
    return CourseSegment(found.seconds, lambda times: found.at(times[:, None]))

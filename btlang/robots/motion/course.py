"""Movements as functions of time, and what is sampled of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil

import numpy as np
import numpy.typing as npt

from btlang.robots.body import Joint
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

PERIOD = 0.01
"""Seconds between two samples."""
_EXACT = 1e-9


class State(Record):
    """Positions, velocities and accelerations, in the units of the joints; arrays whose last axis has the joints."""

    position: Array
    velocity: Array
    acceleration: Array

    def of(self, joints: Sequence[int]) -> State:
        """That of some of the joints."""
        return State(self.position[..., joints], self.velocity[..., joints], self.acceleration[..., joints])

    def rows(self, which: int | slice | Sequence[int] | npt.NDArray[Any]) -> State:
        """Some samples of many, in their order; of a number the one without that axis."""
        return State(self.position[which], self.velocity[which], self.acceleration[which])


class Limits(Record):
    """What some joints can do."""

    low: Array
    high: Array
    speed: Array
    acceleration: Array
    jerk: Array
    rest: Array

    @classmethod
    def of(cls, joints: Sequence[Joint]) -> Limits:
        """Those of the joints, in their order."""
        return cls(*(np.array([getattr(joint, name) for joint in joints]) for name in cls.fields))

    def some(self, joints: Sequence[int]) -> Limits:
        """Those of some of them."""
        return Limits(*(getattr(self, name)[list(joints)] for name in self.fields))


class Piece(Record):
    """What lasts `seconds`; `at` gives the states at an array of times from its beginning."""

    seconds: float
    at: Callable[[Array], State]


def samples(pieces: Sequence[Piece]) -> State:
    """The states of one piece after the other, each PERIOD; the last one is where it ends."""
    begins = np.cumsum([0.0, *(piece.seconds for piece in pieces)])
    times = PERIOD * np.arange(max(1, ceil(begins[-1] / PERIOD - _EXACT)) + 1)
    times = np.minimum(times, begins[-1])
    which = np.clip(np.searchsorted(begins, times, side="right") - 1, 0, len(pieces) - 1)
    found = [piece.at(times[which == index] - begins[index]) for index, piece in enumerate(pieces)]
    return State(*(np.concatenate([getattr(state, name) for state in found]) for name in State.fields))


def between(before: State, after: State, share: float) -> State:
    """The state `share` (0 to 1) of a PERIOD after one sample: the quintic that meets it and the next one."""
    return quintic(before, after, PERIOD).at(np.array([share * PERIOD])).rows(0)


def quintic(start: State, end: State, seconds: float) -> Piece:
    """The polynomial of degree five from one state to another."""
    return Piece(seconds, lambda times: on_quintic(start, end, seconds, times))


def on_quintic(start: State, end: State, seconds: float | Array, times: Array) -> State:
    """States on `quintic` at times from its beginning; with rows of states and a column of seconds, on one for each."""
    h = seconds
    p, v, a = start.position, start.velocity * h, start.acceleration * h * h / 2
    way = end.position - p - v - a
    speed, force = end.velocity * h - v - 2 * a, end.acceleration * h * h - 2 * a
    c3, c4, c5 = 10 * way - 4 * speed + force / 2, -15 * way + 7 * speed - force, 6 * way - 3 * speed + force / 2
    t = np.clip(times[:, None] / h, 0.0, 1.0)
    position = p + t * (v + t * (a + t * (c3 + t * (c4 + t * c5))))
    velocity = (v + t * (2 * a + t * (3 * c3 + t * (4 * c4 + t * 5 * c5)))) / h
    return State(position, velocity, (2 * a + t * (6 * c3 + t * (12 * c4 + t * 20 * c5))) / (h * h))


def to_state(start: State, end: State, limits: Limits, least: float = 0.0) -> Piece | None:
    """The quickest way from one state to another, in at least so many seconds; None if there is none."""
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

    def at(times: Array) -> State:
        states = [found.at_time(float(t)) for t in times]
        shape = (len(states), count)
        return State(*(np.array([state[k] for state in states]).reshape(shape) for k in range(3)))

    return Piece(float(found.duration), at)

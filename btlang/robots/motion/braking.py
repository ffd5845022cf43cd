"""The quickest way to rest for many states at once: what a joint does when it is halted."""

from __future__ import annotations

import numpy as np

from btlang.robots.motion.course import Limits, Piece, State
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record

_TINY = 1e-9


class Brake(Record):
    """From a state: three stretches of constant jerk, which take `first`, `second` and `third` seconds. The jerk of the
    first is `jerk`, and that of the third its opposite.
    """

    start: State
    jerk: Array
    first: Array
    second: Array
    third: Array

    @property
    def seconds(self) -> float:
        """Until all of them rest."""
        return float(np.max(self.first + self.second + self.third, initial=0.0))

    @property
    def end(self) -> State:
        """At rest."""
        return self.at(self.seconds)

    def at(self, seconds: float | Array) -> State:
        """So many seconds later."""
        p, v, a = self.start.position, self.start.velocity, self.start.acceleration
        left = np.asarray(seconds, dtype=np.float64)
        for lasts, jerk in ((self.first, self.jerk), (self.second, 0.0), (self.third, -self.jerk)):
            t = np.clip(left, 0.0, lasts)
            p = p + t * (v + t * (a / 2 + t * jerk / 6))
            v = v + t * (a + t * jerk / 2)
            a = a + t * jerk
            left = left - t
        over = left > 0.0
        return State(p, np.where(over, 0.0, v), np.where(over, 0.0, a))


def brake(state: State, limits: Limits) -> Brake:
    """To rest from a state, or from each of many."""
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


def braking(state: State, limits: Limits) -> Piece:
    """As `brake`, of one state."""
    found = brake(state, limits)
    return Piece(found.seconds, lambda times: found.at(times[:, None]))

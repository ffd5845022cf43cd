"""What is between the key frames of a gesture: quintics within the limits of the joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from btlang.robots.motion.course import Limits, Piece, State, on_quintic, quintic
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record

_LOOKS = 25  # at each quintic
_ROUNDS = 30
_SAFE = 0.999  # of a limit
_BEYOND = 1.001  # slower than needed: without it each round comes nearer to the limits, and none within them
_SHORTEST = 0.01  # seconds between two key frames


class Frames(Record):
    """Where some joints are at which second; the first of them is reached after `times[0]` seconds."""

    times: Array
    positions: Array

    def scaled(self, share: float) -> Frames:
        """In that share of the time."""
        return Frames(self.times * share, self.positions)


class Curve(Record):
    """Frames that were slowed until they keep to the limits, with the velocities there."""

    frames: Frames
    velocities: Array

    def state(self, index: int) -> State:
        """At a key frame."""
        return State(self.frames.positions[index], self.velocities[index], np.zeros_like(self.velocities[index]))

    @property
    def pieces(self) -> Sequence[Piece]:
        """From the first key frame to the last one."""
        times = self.frames.times
        return [quintic(self.state(k), self.state(k + 1), times[k + 1] - times[k]) for k in range(len(times) - 1)]


def curve(frames: Frames, start: Array, limits: Limits, rests: bool) -> Curve:
    """Through the frames from positions at the start; where it `rests` there, the first is reached without speed."""
    steps = np.maximum(np.diff(frames.times), _SHORTEST)
    first = max(float(frames.times[0]), _SHORTEST)
    for turn in range(_ROUNDS + 1):
        times = first + np.concatenate([[0.0], np.cumsum(steps)])
        made = Curve(Frames(times, frames.positions), _velocities(frames.positions, steps, start, first, rests))
        needed = _times_too_fast(made, limits)
        if not len(needed) or needed.max() <= 1.0:
            break
        steps = steps * (np.where(needed > 1.0, needed * _BEYOND, 1.0) if turn < _ROUNDS - 5 else needed.max() * 1.01)
    return made


def _velocities(positions: Array, steps: Array, start: Array, first: float, rests: bool) -> Array:
    """By the slopes on both sides; zero where it holds, turns or ends."""
    slopes = np.diff(positions, axis=0, prepend=start[None]) / np.concatenate([[first], steps])[:, None]
    before, after = slopes[:-1], slopes[1:]
    along = before * after > 0.0
    mean = np.where(along, 2 * before * after / np.where(along, before + after, 1.0), 0.0)
    found = np.concatenate([mean, np.zeros_like(positions[:1])])
    if rests:
        found[0] = 0.0
    return found


def _times_too_fast(made: Curve, limits: Limits) -> Array:
    """Of each piece, in how many times its time it keeps to the limits; all in one go, as speech asks for many."""
    times, positions, velocities = made.frames.times, made.frames.positions, made.velocities
    steps = (times[1:] - times[:-1])[:, None]
    ends = np.concatenate([(positions[1:] - positions[:-1]) / steps, velocities[:-1], velocities[1:]])
    ends = ends.reshape(3, positions[1:].size)
    velocity = (_BY_ENDS.velocity @ ends).reshape(_LOOKS, *positions[1:].shape)
    acceleration = (_BY_ENDS.acceleration @ ends).reshape(velocity.shape) / steps
    jerk = np.abs(acceleration[1:] - acceleration[:-1]) * ((_LOOKS - 1) / steps)
    jerk[[0, -1]] *= 1.5  # it is highest at the ends, beyond differences
    coming = velocity + acceleration * np.abs(acceleration) / (2 * limits.jerk)
    parts = (
        np.abs(velocity).max(axis=0) / limits.speed,
        np.sqrt(np.sqrt(np.abs(coming).max(axis=0) / limits.speed)),  # most of it falls with the time's fourth power
        np.sqrt(np.abs(acceleration).max(axis=0) / limits.acceleration),
        np.cbrt(jerk.max(axis=0) / limits.jerk),
    )
    worst: Array = np.max(parts, axis=(0, 2))
    return worst / _SAFE


def _by_ends() -> State:
    """A quintic of a second at its looks: of a way of 1, of a velocity of 1 as it begins, and of one as it ends.

    Any other one is a sum of these.
    """
    way, begin, end = np.eye(3)
    still = np.zeros(3)
    return on_quintic(State(still, begin, still), State(way, end, still), 1.0, np.linspace(0.0, 1.0, _LOOKS))


_BY_ENDS = _by_ends()

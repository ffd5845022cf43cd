"""What is between the key frames of a gesture: quintics within the limits of the joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from btlang.record import Record
from btlang.robots.motion.course import Limits, Piece, State, on_quintic, quintic
from btlang.robots.motion.kinematics import Array

_LOOKS = 25  # at each quintic
_ROUNDS = 30
_SAFE = 0.999  # of a limit
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
        steps = steps * (np.maximum(needed, 1.0) if turn < _ROUNDS - 5 else needed.max() * 1.01)
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
    pieces, positions, velocities = len(made.velocities) - 1, made.frames.positions, made.velocities
    if not pieces:
        return np.zeros(0)
    times = np.linspace(0.0, np.diff(made.frames.times), _LOOKS, axis=1)
    begins, ends = np.repeat(np.arange(pieces), _LOOKS), np.repeat(np.arange(1, pieces + 1), _LOOKS)
    still = np.zeros_like(velocities[begins])
    start, end = (State(positions[rows], velocities[rows], still) for rows in (begins, ends))
    found = on_quintic(start, end, times[begins, -1:], times.ravel())
    velocity, acceleration = (each.reshape(pieces, _LOOKS, -1) for each in (found.velocity, found.acceleration))
    jerk = np.diff(acceleration, axis=1) / times[:, 1, None, None]
    # it is highest at the ends, beyond differences
    jerk = np.concatenate([1.5 * jerk[:, :1], jerk, 1.5 * jerk[:, -1:]], axis=1)
    coming = velocity + acceleration * np.abs(acceleration) / (2 * limits.jerk)
    parts = (
        np.abs(velocity) / limits.speed,
        np.sqrt(np.sqrt(np.abs(coming) / limits.speed)),  # most of it falls with the fourth power of the time
        np.sqrt(np.abs(acceleration) / limits.acceleration),
        np.cbrt(np.abs(jerk) / limits.jerk),
    )
    worst: Array = np.max([part.max(axis=(1, 2)) for part in parts], axis=0)
    return worst / _SAFE

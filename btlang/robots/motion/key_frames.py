"""What is between the key frames of a gesture: quintics within the limits of the joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from btlang.record import Record
from btlang.robots.motion.course import Limits, Piece, State, quintic
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
        needed = np.array([_times_too_fast(piece, limits) for piece in made.pieces])
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


def _times_too_fast(piece: Piece, limits: Limits) -> float:
    times = np.linspace(0.0, piece.seconds, _LOOKS)
    state = piece.at(times)
    jerk = np.diff(state.acceleration, axis=0) / (times[1] - times[0])
    jerk = np.concatenate([1.5 * jerk[:1], jerk, 1.5 * jerk[-1:]])  # it is highest at the ends, beyond differences
    coming = state.velocity + state.acceleration * np.abs(state.acceleration) / (2 * limits.jerk)
    parts = (
        np.abs(state.velocity) / limits.speed,
        np.sqrt(np.sqrt(np.abs(coming) / limits.speed)),  # most of it falls with the fourth power of the time
        np.sqrt(np.abs(state.acceleration) / limits.acceleration),
        np.cbrt(np.abs(jerk) / limits.jerk),
    )
    return max(float(part.max()) for part in parts) / _SAFE

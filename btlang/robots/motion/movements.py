"""What a body may be asked for: gestures by their key frames, and steps, each with what follows it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Protocol

import numpy as np

from btlang.robots.bodies.gesture import Gesture
from btlang.robots.motion.course import CourseSegment, JointLimits, MotionState, on_quintic, quintic, to_state
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record

_LOOKS = 25  # at each quintic
_ROUNDS = 30
_SAFE = 0.999  # of a limit
_BEYOND = 1.001  # slower than needed: without it each round comes nearer to the limits, and none within them
_SHORTEST = 0.01  # seconds between two key frames
_SAME = 1e-9


class FrameTimes(Record):
    """Positions of some joints by time; the first is reached after `times[0]` seconds."""

    times: Array
    positions: Array

    def scale(self, share: float) -> FrameTimes:
        """Return the same in a share of the time."""
        return FrameTimes(self.times * share, self.positions)


class Curve(Record):
    """Frames that were slowed until they keep to the limits, with the velocities there."""

    frames: FrameTimes
    velocities: Array

    def state(self, index: int) -> MotionState:
        """Return the state at a key frame."""
        return MotionState(self.frames.positions[index], self.velocities[index], np.zeros_like(self.velocities[index]))

    @property
    def pieces(self) -> Sequence[CourseSegment]:
        """The segments from the first key frame to the last one."""
        times = self.frames.times
        return [quintic(self.state(k), self.state(k + 1), times[k + 1] - times[k]) for k in range(len(times) - 1)]


def curve(frames: FrameTimes, start: Array, limits: JointLimits, rests: bool) -> Curve:
    """Return a curve through the frames; if it `rests` at the start, the first frame is reached without speed."""
    steps = np.maximum(np.diff(frames.times), _SHORTEST)
    first = max(float(frames.times[0]), _SHORTEST)
    for turn in range(_ROUNDS + 1):
        times = first + np.concatenate([[0.0], np.cumsum(steps)])
        made = Curve(FrameTimes(times, frames.positions), _velocities(frames.positions, steps, start, first, rests))
        needed = _times_too_fast(made, limits)
        if not len(needed) or needed.max() <= 1.0:
            break
        steps = steps * (np.where(needed > 1.0, needed * _BEYOND, 1.0) if turn < _ROUNDS - 5 else needed.max() * 1.01)
    return made


def _velocities(positions: Array, steps: Array, start: Array, first: float, rests: bool) -> Array:
    """Return velocities from the slopes on both sides; zero where the curve holds, turns or ends."""
    slopes = np.diff(positions, axis=0, prepend=start[None]) / np.concatenate([[first], steps])[:, None]
    before, after = slopes[:-1], slopes[1:]
    along = before * after > 0.0
    mean = np.where(along, 2 * before * after / np.where(along, before + after, 1.0), 0.0)
    found = np.concatenate([mean, np.zeros_like(positions[:1])])
    if rests:
        found[0] = 0.0
    return found


def _times_too_fast(made: Curve, limits: JointLimits) -> Array:
    """Return for each segment by how much it exceeds the limits; all at once, since speech asks for many."""
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


def _by_ends() -> MotionState:
    """Return three quintics of a second, sampled: a distance of 1, a start velocity of 1, and an end velocity of 1.

    Any other quintic is a sum of these.
    """
    way, begin, end = np.eye(3)
    still = np.zeros(3)
    return on_quintic(
        MotionState(still, begin, still), MotionState(way, end, still), 1.0, np.linspace(0.0, 1.0, _LOOKS)
    )


_BY_ENDS = _by_ends()


class Tail(Record):
    """The `pieces` that follow a `first` state, which is reached in `approach` seconds or more.

    The stroke is in seconds after the first state. `slower` is how many times as long they take as they should.
    """

    first: MotionState
    pieces: Sequence[CourseSegment]
    stroke: float
    approach: float = 0.0
    slower: float = 1.0


class Movement(Protocol):
    """A movement of the `joints` with these numbers.

    It may be done in a share of its time, down to `least`. One that `flows` may pass its first position with speed.
    """

    joints: Sequence[int]
    least: float
    flows: bool

    def tail(self, start: MotionState, share: float, rests: bool) -> Tail:
        """Return the movement from a state of these joints; if it `rests`, the first position is
        reached without speed.
        """


class Steps:
    """Positions of some joints one after the other, at rest at each; the stroke is at the first."""

    least = 1.0
    flows = False

    def __init__(self, joints: Sequence[int], steps: Sequence[Array], limits: JointLimits) -> None:
        self.joints, self._steps, self._limits = joints, steps, limits

    def tail(self, start: MotionState, share: float, rests: bool) -> Tail:
        states = [rest_at(step) for step in self._steps]
        pieces = [to_state(one, other, self._limits) for one, other in pairwise(states)]
        return Tail(states[0], [piece for piece in pieces if piece is not None], 0.0)


class KeyFrames:
    """A movement of the key frames of a gesture."""

    flows = True

    def __init__(self, joints: Sequence[int], frames: FrameTimes, gesture: Gesture, limits: JointLimits) -> None:
        self.joints, self.least = joints, gesture.least
        self._frames, self._stroke, self._limits = frames, gesture.stroke, limits

    def tail(self, start: MotionState, share: float, rests: bool) -> Tail:
        wanted = self._frames.scale(share)
        made = curve(wanted, start.position, self._limits, rests)
        given, times = self._frames.times, made.frames.times
        stroke = float(np.interp(self._stroke, given, times)) - float(times[0])
        if self._stroke < given[0]:
            stroke = float(self._stroke - given[0]) * share
        asked = float(wanted.times[-1] - wanted.times[0])
        taken = float(times[-1] - times[0])
        slower = taken / asked if asked > _SAME else 1.0
        return Tail(made.state(0), made.pieces, stroke, float(wanted.times[0]), slower)


def rest_at(position: Array) -> MotionState:
    """Return the state at rest in a position."""
    return MotionState(position, np.zeros_like(position), np.zeros_like(position))


def stay_at(position: Array) -> Callable[[Array], MotionState]:
    """Return the states at rest in a position at some times."""
    return lambda times: rest_at(np.repeat(position[None], len(times), axis=0))


def frames_of(gesture: Gesture, names: Sequence[str], settled: Array) -> FrameTimes:
    """Return the key frames as positions of the joints of these `names`, which would come to rest `settled`."""
    times: list[float] = []
    rows: list[Array] = []
    row = settled
    for frame in gesture.frames:
        row = row.copy()
        row[[names.index(name) for name in frame.joints]] = [float(value) for value in frame.joints.values()]
        times.append(frame.at)
        rows.append(row)
        if frame.hold > 0.0:
            times.append(frame.at + frame.hold)
            rows.append(row)
    return FrameTimes(np.array(times), np.array(rows))

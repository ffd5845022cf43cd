"""What a body may be asked for: gestures and steps, each as what follows once its first position is reached."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Protocol

import numpy as np

from btlang.robots.gesture import Gesture
from btlang.robots.motion.course import Limits, Piece, State, to_state
from btlang.robots.motion.key_frames import Frames, curve
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record

_SAME = 1e-9


class Tail(Record):
    """From a `first` state, which is reached in `approach` seconds or more: the `pieces` that follow, and when the
    stroke is, in seconds after the first state. `slower` is how many times as long they take as they should.
    """

    first: State
    pieces: Sequence[Piece]
    stroke: float
    approach: float = 0.0
    slower: float = 1.0


class Movement(Protocol):
    """Of the `joints` with these numbers. It may be done in a share of its time, down to `least`. One that `flows` may
    pass its first position with speed.
    """

    joints: Sequence[int]
    least: float
    flows: bool

    def tail(self, start: State, share: float, rests: bool) -> Tail:
        """From a state of these joints; where it `rests`, its first position is reached without speed."""


class Steps:
    """Positions of some joints one after the other, at rest at each; the stroke is at the first."""

    least = 1.0
    flows = False

    def __init__(self, joints: Sequence[int], steps: Sequence[Array], limits: Limits) -> None:
        self.joints, self._steps, self._limits = joints, steps, limits

    def tail(self, start: State, share: float, rests: bool) -> Tail:
        """See Movement."""
        states = [resting(step) for step in self._steps]
        pieces = [to_state(one, other, self._limits) for one, other in pairwise(states)]
        return Tail(states[0], [piece for piece in pieces if piece is not None], 0.0)


class KeyFrames:
    """A gesture of key frames."""

    flows = True

    def __init__(self, joints: Sequence[int], frames: Frames, gesture: Gesture, limits: Limits) -> None:
        self.joints, self.least = joints, gesture.least
        self._frames, self._stroke, self._limits = frames, gesture.stroke, limits

    def tail(self, start: State, share: float, rests: bool) -> Tail:
        """See Movement."""
        wanted = self._frames.scaled(share)
        made = curve(wanted, start.position, self._limits, rests)
        given, times = self._frames.times, made.frames.times
        stroke = float(np.interp(self._stroke, given, times)) - float(times[0])
        if self._stroke < given[0]:
            stroke = float(self._stroke - given[0]) * share
        asked = float(wanted.times[-1] - wanted.times[0])
        taken = float(times[-1] - times[0])
        slower = taken / asked if asked > _SAME else 1.0
        return Tail(made.state(0), made.pieces, stroke, float(wanted.times[0]), slower)


def resting(position: Array) -> State:
    """At rest there."""
    return State(position, np.zeros_like(position), np.zeros_like(position))


def staying(position: Array) -> Callable[[Array], State]:
    """At rest there at each of some times."""
    return lambda times: resting(np.repeat(position[None], len(times), axis=0))


def frames_of(gesture: Gesture, names: Sequence[str], settled: Array) -> Frames:
    """The key frames as positions of the joints of these `names`, which would come to rest `settled`."""
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
    return Frames(np.array(times), np.array(rows))

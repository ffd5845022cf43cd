"""Ways to do a movement from where a body is: the best first. Whether one may be gone is not asked here."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import floor, inf

from btlang.robots.motion.braking import brake, braking
from btlang.robots.motion.course import PERIOD, Limits, Piece, State, to_state
from btlang.robots.motion.movements import Movement, Tail, resting, staying
from btlang.support.record import Record

_EXACT = 1e-6
_SLOWED = 1.02  # times as long: less is not worth a word


class Course(Record):
    """What some joints do from so many ticks on; the stroke is `stroke` seconds after the first tick of all."""

    joints: Sequence[int]
    begins: int
    pieces: Sequence[Piece]
    stroke: float
    slower: float = 1.0


class Planner:
    """Of all joints of a body."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits

    def courses(self, movement: Movement, state: Callable[[int], State], room: float | None = None) -> Iterator[Course]:
        """Ways to do it from now on, where all joints are in the `state` so many ticks from now as things are.

        With `room`, the stroke is so many seconds from now, or as soon after as is possible.
        """
        joints = movement.joints
        limits, start = self._limits.some(joints), state(0).of(joints)
        for rests in (False, True) if movement.flows else (True,):
            course = self._direct(movement, limits, lambda ticks: state(ticks).of(joints), rests, room)
            if course is not None:
                yield course
        stop, stopped = braking(start, limits), brake(start, limits).end
        home = resting(limits.rest)
        by_rest = to_state(start, home, limits)
        for before, begin in ((stop, stopped), (by_rest, home)):
            if before is not None:
                left = None if room is None else room - before.seconds
                course = self._direct(movement, limits, lambda ticks, begin=begin: begin, True, left)  # type: ignore[misc]
                if course is not None:
                    waits = Piece(PERIOD * course.begins, staying(begin.position))
                    pieces = (before, waits, *course.pieces)
                    yield course.replace(begins=0, pieces=pieces, stroke=course.stroke + before.seconds)

    def stop(self, joints: Sequence[int], state: State) -> Course:
        """To rest, as fast as they can."""
        return Course(joints, 0, [braking(state.of(joints), self._limits.some(joints))], 0.0)

    def soonest(self, movement: Movement, state: State) -> float:
        """Seconds until its stroke at least."""
        course = next(self.courses(movement, lambda ticks: state, -inf), None)
        return course.stroke if course is not None else 0.0

    def _direct(
        self, movement: Movement, limits: Limits, state: Callable[[int], State], rests: bool, room: float | None
    ) -> Course | None:
        start, share, wanted = state(0), 1.0, inf if room is None else room
        tail, approach = self._parts(movement, limits, start, share, rests)
        for _ in range(2):  # once in the share that is missing; then as fast as it may be
            stroke = approach.seconds + tail.stroke if approach is not None else inf
            if stroke <= wanted + _EXACT or share <= movement.least:
                break
            share = max(movement.least, share * wanted / stroke) if share == 1.0 else movement.least
            tail, approach = self._parts(movement, limits, start, share, rests)
        if approach is None:
            return None
        slower = max(tail.slower, approach.seconds / tail.approach if tail.approach > 0.0 else 1.0)
        begins, early = 0, wanted - approach.seconds - tail.stroke
        if room is not None and early > _EXACT:
            begins = floor(early / PERIOD)
            later = to_state(state(begins), tail.first, limits, wanted - tail.stroke - begins * PERIOD)
            if later is None or abs(begins * PERIOD + later.seconds + tail.stroke - wanted) > _EXACT:
                begins, later = 0, to_state(start, tail.first, limits, wanted - tail.stroke)
            if later is None:
                return None
            approach = later
        stroke = begins * PERIOD + approach.seconds + tail.stroke
        return Course(movement.joints, begins, (approach, *tail.pieces), stroke, slower if slower > _SLOWED else 1.0)

    @staticmethod
    def _parts(
        movement: Movement, limits: Limits, start: State, share: float, rests: bool
    ) -> tuple[Tail, Piece | None]:
        tail = movement.tail(start, share, rests)
        return tail, to_state(start, tail.first, limits, tail.approach)

"""Plans for all joints of a body: ways to do a movement, and what the joints will do from now on."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import ceil, floor, inf

import numpy as np

from btlang.robots.bodies.body import Body
from btlang.robots.motion.course import (
    PERIOD,
    CourseSegment,
    JointLimits,
    MotionState,
    between,
    brake,
    plan_brake,
    quintic,
    samples,
    to_state,
)
from btlang.robots.motion.guard.trajectories import TrajectoryCheck
from btlang.robots.motion.kinematics import Array, Kinematics
from btlang.robots.motion.movements import Movement, Tail, rest_at, stay_at
from btlang.robots.robot import RobotError
from btlang.support.record import Record

_EXACT = 1e-6
_SLOWED = 1.02  # times as long: less is not worth a word
_SAME = 6  # digits of positions that are the same
_MOST = 100  # idle movements that are known to be safe


class Course(Record):
    """A plan for some joints from a tick on; the stroke is `stroke` seconds after the first tick of all."""

    joints: Sequence[int]
    begins: int
    pieces: Sequence[CourseSegment]
    stroke: float
    slower: float = 1.0


class MotionPlanner:
    """A planner of movements for all joints of a body."""

    def __init__(self, limits: JointLimits) -> None:
        self._limits = limits

    def courses(
        self, movement: Movement, state: Callable[[int], MotionState], room: float | None = None
    ) -> Iterator[Course]:
        """Yield courses for a movement, the best first, from the `state` of all joints so many ticks from now.

        With `room`, the stroke is so many seconds from now, or as soon after that as possible.
        """
        joints = movement.joints
        limits, start = self._limits.some(joints), state(0).of(joints)
        for rests in (False, True) if movement.flows else (True,):
            course = self._direct(movement, limits, lambda ticks: state(ticks).of(joints), rests, room)
            if course is not None:
                yield course
        stop, stopped = plan_brake(start, limits), brake(start, limits).end
        home = rest_at(limits.rest)
        by_rest = to_state(start, home, limits)
        for before, begin in ((stop, stopped), (by_rest, home)):
            if before is not None:
                left = None if room is None else room - before.seconds
                course = self._direct(movement, limits, lambda ticks, begin=begin: begin, True, left)  # type: ignore[misc]
                if course is not None:
                    waits = CourseSegment(PERIOD * course.begins, stay_at(begin.position))
                    pieces = (before, waits, *course.pieces)
                    yield course.replace(begins=0, pieces=pieces, stroke=course.stroke + before.seconds)

    def stop(self, joints: Sequence[int], state: MotionState) -> Course:
        """Plan the fastest stop for all joints."""
        return Course(joints, 0, [plan_brake(state.of(joints), self._limits.some(joints))], 0.0)

    def soonest(self, movement: Movement, state: MotionState) -> float:
        """Return the least seconds until the stroke."""
        course = next(self.courses(movement, lambda ticks: state, -inf), None)
        return course.stroke if course is not None else 0.0

    def _direct(
        self,
        movement: Movement,
        limits: JointLimits,
        state: Callable[[int], MotionState],
        rests: bool,
        room: float | None,
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
        movement: Movement, limits: JointLimits, start: MotionState, share: float, rests: bool
    ) -> tuple[Tail, CourseSegment | None]:
        tail = movement.tail(start, share, rests)
        return tail, to_state(start, tail.first, limits, tail.approach)


class PlannedMotion:
    """A course under way, as an Operation. `stroke` is a second of its timeline."""

    def __init__(self, timeline: JointTimeline, joints: Iterable[int], stroke: float, slower: float) -> None:
        self._timeline, self.joints, self.stroke, self.slower = timeline, set(joints), stroke, slower
        self.done = False
        self.failure: str | None = None

    def cancel(self) -> None:
        """Brake its joints to rest."""
        if not self.done:
            self._timeline.freeze(self.joints)
            self.end(None)

    def end(self, failure: str | None) -> None:
        """End the motion."""
        self.done, self.failure = True, failure


class JointTimeline:
    """The plan of all joints of a body, at rest at first. All methods are for any thread; `halt` takes no lock.

    New movements begin at the next tick; ticks are PERIOD apart. Its state can always be braked without a collision and
    within all limits.
    """

    def __init__(self, body: Body, kinematics: Kinematics) -> None:
        self.seconds = 0.0
        self._limits = JointLimits.of(body.joints)
        self._guard, self._planner = TrajectoryCheck(body, kinematics), MotionPlanner(self._limits)
        self._way = rest_at(self._limits.rest[None])
        self._first = 0  # the tick of the first sample
        self._ends = np.zeros(len(body.joints), dtype=int)  # the tick at which each joint rests
        self._plays: list[PlannedMotion] = []
        self._idle: frozenset[int] = frozenset()
        self._may: dict[object, bool] = {}
        self._halts, self._halted = False, ""
        self._lock = threading.RLock()

    @property
    def state(self) -> MotionState:
        """The state of all joints now."""
        return self.at(self.seconds)

    @property
    def plan(self) -> tuple[float, MotionState]:
        """What all joints do until they rest: samples from a second on, PERIOD apart. A new array whenever that
        changes.
        """
        with self._lock:
            return self._first * PERIOD, self._way

    def at(self, seconds: float) -> MotionState:
        """Return the planned state of all joints at a future second."""
        with self._lock:
            ticks = seconds / PERIOD
            whole = floor(ticks + _EXACT)
            share = ticks - whole
            return (
                self._sample(whole) if share <= _EXACT else between(self._sample(whole), self._sample(whole + 1), share)
            )

    def rests(self, joints: Sequence[int] | None = None) -> bool:
        """Return whether these joints, or all of them, are where they will stay."""
        ends = self._ends if joints is None else self._ends[list(joints)]
        return not len(ends) or self.seconds / PERIOD >= int(ends.max()) - _EXACT

    def is_free(self, joints: Sequence[int] | None = None) -> bool:
        """Return whether these joints rest, apart from idle motion."""
        if self.rests(joints):
            return True
        idle = self._idle
        return bool(idle) and self.rests([k for k in joints or range(len(self._ends)) if k not in idle])

    def put(self, positions: Array) -> None:
        """Put the joints that rest at their positions among those of all."""
        with self._lock:
            still = self.seconds / PERIOD >= self._ends - _EXACT
            way = self._between(self._tick - 1, int(self._ends.max()))
            way.position[:, still] = positions[still]
            self._way, self._first = way, self._tick - 1

    def step(self, dt: float) -> None:
        """Let so many seconds pass."""
        with self._lock:
            self._begin_halt()
            self.seconds += dt
            for play in self._plays:
                if not play.done and self.rests(list(play.joints)):
                    play.end(None)
            self._plays = [play for play in self._plays if not play.done]

    def play(
        self, courses: Callable[[MotionPlanner, Callable[[int], MotionState], float], Iterator[Course]]
    ) -> PlannedMotion:
        """Start the first course that passes the check; `find` gets the states after ticks, and the seconds until the
        first.

        Raises RobotError if there is none.
        """
        with self._lock:
            self._begin_halt()
            tick, problem = self._tick, ""
            wait = tick * PERIOD - self.seconds
            for course in courses(self._planner, lambda ticks: self._sample(tick + ticks), wait):
                way, ends = self._with(course, tick)
                found = self._guard.problem(way, list(course.joints))
                if not found:
                    self._take(way, ends, tick, course.joints)
                    made = PlannedMotion(self, course.joints, tick * PERIOD + course.stroke, course.slower)
                    self._plays.append(made)
                    self._halted = ""
                    return made
                problem = problem or found
            raise RobotError(problem or "the body can't move like that")

    def idle(self, joints: Sequence[int], goal: Array, seconds: float) -> bool:
        """Move to a goal; return whether it does: not if the joints move, or the body would touch itself.

        Anything else replaces idle motion.
        """
        with self._lock:
            self._begin_halt()
            if not self.rests(joints):
                return False
            tick = self._tick
            here = self._sample(tick).of(joints).position
            piece = quintic(rest_at(here), rest_at(goal), seconds)
            way, ends = self._with(Course(joints, 0, [piece], 0.0), tick)
            if not self._may_idle(way, joints, (tuple(joints), goal.round(_SAME).tobytes(), seconds)):
                return False
            self._take(way, ends, tick, joints)
            self._idle |= set(joints)
            return True

    def _may_idle(self, way: MotionState, joints: Sequence[int], what: object) -> bool:
        """Return whether an idle movement passes the check, cached: from rest the same one is asked for again and
        again.
        """
        if not self.rests():
            return not self._guard.problem(way, list(joints))
        key = what, (way.position[0].round(_SAME) + 0.0).tobytes()  # and not -0.0
        if key not in self._may:
            if len(self._may) >= _MOST:
                self._may.clear()
            self._may[key] = not self._guard.problem(way, list(joints))
        return self._may[key]

    def soonest(self, find: Callable[[MotionPlanner, MotionState], float]) -> float:
        """Return what `find` makes of the state in which something new would begin, and the seconds until then."""
        with self._lock:
            return self._tick * PERIOD - self.seconds + find(self._planner, self._sample(self._tick))

    def follow(self, joints: Sequence[int], at: Callable[[Array], MotionState], begins: float, ends: float) -> None:
        """Let joints follow an external movement, which isn't checked, from one second to another; then they rest.

        `at` returns their states at an array of seconds. If everything was to halt, it halts like that.
        """
        with self._lock:
            self._end_plays()
            tick = self._tick
            wait = max(0, ceil(begins / PERIOD - _EXACT) - tick)
            first = (tick + wait) * PERIOD
            piece = CourseSegment(max(PERIOD, ends - first), lambda times: at(times + first))
            self._take(*self._with(Course(joints, wait, [piece], 0.0), tick), tick, joints)

    def freeze(self, joints: Iterable[int]) -> None:
        """Brake these joints to rest; all of them, if the others would run into them."""
        with self._lock:
            self._begin_halt()
            wanted = sorted(joints)
            if wanted and not self.rests(wanted):
                course = self._planner.stop(wanted, self._sample(self._tick))
                way, ends = self._with(course, self._tick)
                if self._guard.problem(way, wanted):
                    self.halt("other joints had to stop")
                    self._begin_halt()
                else:
                    self._take(way, ends, self._tick, wanted)

    def halt(self, reason: str = "the robot was stopped") -> None:
        """Brake all joints to rest, from the next step on."""
        self._halts = True
        self._halted = reason

    def _end_plays(self) -> bool:
        """End all motions if they were to halt; return whether they were."""
        halts, self._halts = self._halts, False
        for play in self._plays if halts else ():
            play.end(self._halted)
        return halts

    def _begin_halt(self) -> None:
        if self._end_plays() and not self.rests():
            course = self._planner.stop(range(len(self._ends)), self._sample(self._tick))
            way, ends = self._with(course, self._tick)
            self._take(way, ends, self._tick, course.joints)

    @property
    def _tick(self) -> int:
        """The next tick, at which something new begins."""
        return ceil(self.seconds / PERIOD - _EXACT)

    def _sample(self, tick: int) -> MotionState:
        at = min(max(tick - self._first, 0), len(self._way.position) - 1)
        return self._way.rows(at)

    def _between(self, tick: int, end: int) -> MotionState:
        """Return a copy of what all joints do from one tick to another, or at the first."""
        rows = np.clip(np.arange(tick, max(tick, end) + 1) - self._first, 0, len(self._way.position) - 1)
        return self._way.rows(rows)

    def _with(self, course: Course, tick: int) -> tuple[MotionState, Array]:
        """Return what all joints do from a tick on if some take a course, and when each of them rests."""
        new, joints = samples(course.pieces), list(course.joints)
        ends = self._ends.copy()
        ends[joints] = tick + course.begins + len(new.position) - 1
        since, made = self._between(tick, int(ends.max())), []
        for name in MotionState.fields:
            values, old = getattr(new, name).copy(), getattr(since, name)
            if name != "position":
                values[-1] = 0.0
            old[course.begins : course.begins + len(values), joints] = values
            old[course.begins + len(values) :, joints] = values[-1]
            made.append(old)
        return MotionState(*made), ends

    def _take(self, way: MotionState, ends: Array, tick: int, joints: Sequence[int]) -> None:
        before = self._sample(tick - 1)
        self._way = MotionState(
            *(np.concatenate([getattr(before, name)[None], getattr(way, name)]) for name in MotionState.fields)
        )
        self._first, self._ends = tick - 1, ends
        self._idle -= set(joints)
        for play in self._plays:
            play.joints -= set(joints)
            if not play.joints and not play.done:
                play.end(None if self.seconds >= play.stroke else "another movement took over")

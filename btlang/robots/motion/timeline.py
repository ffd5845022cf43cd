"""What all joints of a body will do from now on, as samples, and who wants it so."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import ceil, floor

import numpy as np

from btlang.robots.body import Body
from btlang.robots.motion.course import PERIOD, Limits, Piece, State, between, samples
from btlang.robots.motion.guard import Guard
from btlang.robots.motion.kinematics import Array, Kinematics
from btlang.robots.motion.movements import resting
from btlang.robots.motion.planner import Course, Planner
from btlang.robots.robot import RobotError

_EXACT = 1e-6


class Play:
    """See btlang.robots.capabilities.Operation: a course on its way. `stroke` is a second of its timeline."""

    def __init__(self, timeline: Timeline, joints: Iterable[int], stroke: float, slower: float) -> None:
        self._timeline, self.joints, self.stroke, self.slower = timeline, set(joints), stroke, slower
        self.done = False
        self.failure: str | None = None

    def cancel(self) -> None:
        """Its joints come to rest."""
        if not self.done:
            self._timeline.freeze(self.joints)
            self.end(None)

    def end(self, failure: str | None) -> None:
        """It is over."""
        self.done, self.failure = True, failure


class Timeline:
    """Of a body, at rest at first. It begins what is new at the next of its ticks, which are PERIOD apart.

    Its state can always be braked without a collision and within all limits. All is for any thread; `halt` takes no
    lock.
    """

    def __init__(self, body: Body, kinematics: Kinematics) -> None:
        self.seconds = 0.0
        self._limits = Limits.of(body.joints)
        self._guard, self._planner = Guard(body, kinematics), Planner(self._limits)
        self._way = resting(self._limits.rest[None])
        self._first = 0  # the tick of the first sample
        self._ends = np.zeros(len(body.joints), dtype=int)  # the tick at which each joint rests
        self._plays: list[Play] = []
        self._halts, self._halted = False, ""
        self._lock = threading.RLock()

    @property
    def state(self) -> State:
        """Of all joints, now."""
        return self.at(self.seconds)

    @property
    def plan(self) -> tuple[float, State]:
        """What all joints do until they rest: samples from a second on, PERIOD apart. New whenever that changes."""
        with self._lock:
            return self._first * PERIOD, self._way

    def at(self, seconds: float) -> State:
        """Of all joints at a second that is to come, as things are."""
        with self._lock:
            ticks = seconds / PERIOD
            whole = floor(ticks + _EXACT)
            share = ticks - whole
            return (
                self._sample(whole) if share <= _EXACT else between(self._sample(whole), self._sample(whole + 1), share)
            )

    def rests(self, joints: Sequence[int] | None = None) -> bool:
        """Whether these joints, or all of them, are where they will stay."""
        ends = self._ends if joints is None else self._ends[list(joints)]
        return not len(ends) or self.seconds / PERIOD >= int(ends.max()) - _EXACT

    def put(self, positions: Array) -> None:
        """The body is there, at rest."""
        with self._lock:
            self._way, self._first = resting(positions[None]), self._tick
            self._ends[:] = self._tick

    def step(self, dt: float) -> None:
        """So many seconds pass."""
        with self._lock:
            self._begin_halt()
            self.seconds += dt
            for play in self._plays:
                if not play.done and self.rests(list(play.joints)):
                    play.end(None)
            self._plays = [play for play in self._plays if not play.done]

    def play(self, courses: Callable[[Planner, Callable[[int], State], float], Iterator[Course]]) -> Play:
        """Sets off on the first course that may be gone; it gets the states after ticks, and seconds until the first.

        Raises RobotError where there is none.
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
                    made = Play(self, course.joints, tick * PERIOD + course.stroke, course.slower)
                    self._plays.append(made)
                    self._halted = ""
                    return made
                problem = problem or found
            raise RobotError(problem or "the body can't move like that")

    def soonest(self, find: Callable[[Planner, State], float]) -> float:
        """What `find` makes of the state in which something new would begin, and the seconds until then."""
        with self._lock:
            return self._tick * PERIOD - self.seconds + find(self._planner, self._sample(self._tick))

    def follow(self, joints: Sequence[int], at: Callable[[Array], State], begins: float, ends: float) -> None:
        """From one second to another, these go a way that comes from elsewhere and isn't checked; then they rest.

        `at` gives their states at an array of seconds. Where everything was to halt, it halts like that.
        """
        with self._lock:
            self._end_plays()
            tick = self._tick
            wait = max(0, ceil(begins / PERIOD - _EXACT) - tick)
            first = (tick + wait) * PERIOD
            piece = Piece(max(PERIOD, ends - first), lambda times: at(times + first))
            self._take(*self._with(Course(joints, wait, [piece], 0.0), tick), tick, joints)

    def freeze(self, joints: Iterable[int]) -> None:
        """These come to rest; all of them, where the others would run into them."""
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
        """All joints come to rest, from the next step on."""
        self._halts = True
        self._halted = reason

    def _end_plays(self) -> bool:
        """Ends all of them where they were to halt, and says whether they were."""
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
        """The next one, which something new begins at."""
        return ceil(self.seconds / PERIOD - _EXACT)

    def _sample(self, tick: int) -> State:
        at = min(max(tick - self._first, 0), len(self._way.position) - 1)
        return State(*(getattr(self._way, name)[at] for name in State.fields))

    def _with(self, course: Course, tick: int) -> tuple[State, Array]:
        """What all joints do from a tick on where some take a course, and when each of them rests."""
        new, joints = samples(course.pieces), list(course.joints)
        ends = self._ends.copy()
        ends[joints] = tick + course.begins + len(new.position) - 1
        count = max(int(ends.max()) - tick, 0) + 1
        rows = np.clip(np.arange(tick, tick + count) - self._first, 0, len(self._way.position) - 1)
        made = []
        for name in State.fields:
            values, old = getattr(new, name).copy(), getattr(self._way, name)[rows]
            if name != "position":
                values[-1] = 0.0
            old[course.begins : course.begins + len(values), joints] = values
            old[course.begins + len(values) :, joints] = values[-1]
            made.append(old)
        return State(*made), ends

    def _take(self, way: State, ends: Array, tick: int, joints: Sequence[int]) -> None:
        before = self._sample(tick - 1)
        self._way = State(*(np.concatenate([getattr(before, name)[None], getattr(way, name)]) for name in State.fields))
        self._first, self._ends = tick - 1, ends
        for play in self._plays:
            play.joints -= set(joints)
            if not play.joints and not play.done:
                play.end(None if self.seconds >= play.stroke else "another movement took over")

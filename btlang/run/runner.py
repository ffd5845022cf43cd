"""Runs a mission: ticks its tree at a fixed rate, moves the clock and the robot, and leaves the robot at rest."""

from __future__ import annotations

import math
from _thread import get_ident
from collections import deque
from collections.abc import Callable, Mapping
from threading import Event

from btlang.engine.blackboard import Blackboard
from btlang.engine.engine import Engine, Failure
from btlang.engine.leaves.leaf import LeafBinding, find_raising_line
from btlang.engine.status import IDLE, NAMES, RUNNING
from btlang.run.bus import Bus
from btlang.run.controls import Controls, disable
from btlang.run.events import Ended, PeriodPassed, StatusesChanged, Troubled, Warned
from btlang.run.outcome import EMERGENCY, SUSPENDED, Outcome, Standstill, describe_caught, standstill_of
from btlang.run.pace import Overruns, Pace
from btlang.run.robot_state import read_robot
from btlang.run.statuses import Status
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    from btlang.engine.changes import Changes
    from btlang.engine.clock import LeafTimer
    from btlang.engine.instance import Hooks
    from btlang.run.events import Robot

    class Ticked(Protocol):
        """A thing that a run ticks: an Engine, or several that count as one.

        `idle` may be missing: whether there is nothing to tick now, so that the robot need not be enabled yet. So may
        `works_beside`: whether anything works in a thread.
        """

        on_wake: Callable[[], object] | None

        @property
        def failure(self) -> Failure | None: ...

        def tick(self) -> int: ...

        def halt(self, emergency: bool = False) -> None: ...

        def suspend(self) -> None: ...

        def take_halt_failures(self) -> list[Failure]: ...

        def close(self, patience: float = 0.0) -> list[Failure]: ...


_LOOK = 0.5  # seconds of real time after which who waits for a tick looks whether the run goes on
_REST = 2.0  # seconds of the mission that a robot gets to come to rest
_PATIENCE = 2.0  # seconds of real time that background leaves get to end after the last halt


def trace_engine(
    tree: Tree,
    bind: Callable[[str], LeafBinding | None],
    *,
    bus: Bus,
    services: Mapping[str, Any] = {},
    blackboard: Blackboard | None = None,
    stopwatch: LeafTimer | None = None,
    proxies: Mapping[str, Callable[..., Any]] = {},
    hooks: Hooks | None = None,
) -> Engine:
    """Return an engine whose status changes go on the bus, and once a run each condition that isn't known or leaf that
    raised.

    The time of day and the weekday are those of the robot, where it knows.
    """
    robot: Any = services.get("robot")
    if hasattr(robot, "time_of_day"):
        bus.clock.day = lambda: float(robot.time_of_day)
    if hasattr(robot, "weekday"):
        bus.clock.week = lambda: int(robot.weekday)

    def changed(changes: Changes) -> None:
        bus.emit(StatusesChanged, changes, engine, engine.valued(changes))

    def warned(failure: Failure) -> None:
        what = "is not known" if engine.is_question(failure.index) else "failed"
        place = find_raising_line(failure.exception)
        text = f"'{failure.node.source_text}' {what}: {failure.reason}" + (f" (raised in {place})" if place else "")
        bus.emit(Warned, text, failure.path, _place(failure))

    engine = Engine(
        tree,
        bind,
        clock=bus.clock,
        services=services,
        blackboard=blackboard,
        listener=changed,
        stopwatch=stopwatch,
        on_warning=warned,
        proxies=proxies,
        hooks=hooks,
    )
    bus.before = engine.flush
    return engine


class Runner:
    """A runner that ticks an engine `rate` times a second of the mission until the tree completes.

    `speed` is seconds of the mission per second of real time; math.inf waits only for background leaves, in real time.
    `pace` makes what waits between two ticks and returns how much time has passed. The next tick comes sooner if a node
    is due before the period is over (Clock.due), and at once if the service `wake` of the engine is called. Where the
    engine has a stopwatch, ticks that take longer than their period are events (Overrun).

    A pause suspends the tree (see Engine.suspend) and brakes the robot. Then the time of the mission stands still, and
    so does a simulated world once the robot is at rest.
    """

    def __init__(
        self,
        engine: Ticked,
        *,
        bus: Bus | None = None,
        robot: Robot | None = None,
        rate: float = 20.0,
        speed: float = 1.0,
        time_limit: float | None = None,
        controls: Controls | None = None,
        pace: Callable[[float, Controls], Pace] = Pace,
    ) -> None:
        self._engine = engine
        self._bus = Bus() if bus is None else bus
        self._clock = self._bus.clock
        self._robot = robot
        self._period = 1 / rate
        self._pause = self._period / speed
        self._limit = math.inf if time_limit is None else time_limit
        self.controls = Controls() if controls is None else controls
        self._suspended = False
        self._disabled = True  # whether the robot has to be enabled before the next tick
        self._began = self._clock.now
        self._pace = pace(speed, self.controls)
        self._overruns: Overruns | None = None
        if isinstance(engine, Engine) and engine.stopwatch is not None and speed < math.inf:
            allowed = self._period if speed > 1 else 0.0  # which is all that it may take on a robot
            self._overruns = Overruns(engine, engine.stopwatch, self._pause, self._bus, allowed)
        self.ticks = 0
        self.after_tick: Callable[[], object] | None = None
        """A function to call after each tick of the tree, in the thread of the run."""
        self._requests: deque[Callable[[], object]] = deque()
        self._thread = 0  # that of `run`, while it goes on
        self.controls.robot = robot
        engine.on_wake = self._pace.wake

    def halt(self) -> None:
        """Halt the tree and stops the robot, outside of run(); the next tick starts the tree again."""
        self._end()

    def tick(self, seconds: float | None = None) -> int:
        """Tick the tree, then, unless it completed, moves clock and robot on by `seconds`, or one period.

        Returns the status.

        After an emergency stop, also one during this tick, it halts the tree instead and returns IDLE.
        """
        if seconds is not None and not 0 < seconds < math.inf:
            raise ValueError(f"the time that passes behind a tick must be positive, not {seconds!r}")
        status = IDLE if self.controls.emergency else self._tick(self._engine)
        if self.controls.emergency:
            self._end()
            self.controls.take_emergency()
            return IDLE
        if status == RUNNING:
            self._advance(self._period_left() if seconds is None else seconds)
        else:
            self._engine.close()
        return status

    def completed(
        self, status: Status, stopped: str = "", seconds: float | None = None, standstill: Standstill | None = None
    ) -> Outcome:
        """Return the outcome of a tree that came to this status, or was `stopped`, after so many seconds, by default
        now.
        """
        failure = None if stopped else self._engine.failure
        count, worst = (self._overruns.count, self._overruns.worst) if self._overruns is not None else (0, None)
        standstill = Standstill() if standstill is None else standstill
        raised = getattr(self._engine, "raised", {}).values()
        seconds = self._clock.now - self._began if seconds is None else seconds
        return Outcome(
            status,
            seconds,
            self.ticks,
            failure,
            stopped,
            count,
            worst,
            standstill,
            exceptions=tuple(each.exception for each in raised),
            caught=describe_caught(raised, failure),
            unanswered=tuple(text for text, _ in self._unanswered()),
        )

    def _unanswered(self) -> list[tuple[str, Failure]]:
        """Say which rules did nothing, as their conditions were never known."""
        texts: dict[str, Failure] = {}
        for failure in getattr(self._engine, "unanswered", ()):
            words = failure.node.source_text
            texts.setdefault(f"A rule did nothing: '{words}' was never known ({failure.reason}).", failure)
        return list(texts.items())

    def between_ticks(self, call: Callable[[], Any]) -> Any:
        """Return what `call` returns or raises, between two ticks of `run`. From any thread; waits until then."""
        if self._thread in (0, get_ident()):
            return call()
        answered = Event()
        answers: list[Any] = []
        problems: list[Exception] = []

        def request() -> None:
            try:
                answers.append(call())
            except Exception as problem:
                problems.append(problem)
            answered.set()

        self._requests.append(request)
        self.controls.wake()
        while not answered.wait(_LOOK):
            if not self._thread:  # it ended meanwhile
                self._answer_requests()
        if problems:
            raise problems[0]
        return answers[0]

    def end_requests(self) -> None:
        """Do what still waits, as the run is over: from now on `between_ticks` calls at once."""
        self._thread = 0
        self._answer_requests()

    def _answer_requests(self) -> None:
        while self._requests:
            self._requests.popleft()()

    def run(self) -> Outcome:
        """Run to the end, the time limit, a stop or Ctrl-C; then halt the tree and bring the robot to rest.

        An emergency stop counts also where it comes during the latter. An exception other than KeyboardInterrupt does
        the same and comes through.
        """
        self._began, self.ticks = self._clock.now, 0
        self._thread = get_ident()
        self._publish_period()
        try:
            status, stopped = self._loop()
        except KeyboardInterrupt:
            status, stopped = IDLE, "interrupted"
        finally:
            seconds = self._clock.now - self._began
            standstill = self._end(suspends=self.controls.suspends)
        if self.controls.emergency:
            status, stopped = IDLE, EMERGENCY
        outcome = self.completed(Status(status), stopped, seconds, standstill)
        for text, failure in self._unanswered():
            self._bus.emit(Warned, text, failure.path, _place(failure))
        self._bus.emit(Ended, *_ending(outcome))
        return outcome

    def _loop(self) -> tuple[int, str]:
        controls, stepped = self.controls, False
        self._pace.begin()
        while not controls.stopped:
            self._answer_requests()
            if controls.paused and not controls.take_step():
                self._stand_still(stepped)
                self._pace.begin()
                continue
            stepped = controls.paused
            if self._clock.now - self._began >= self._limit - 1e-9:
                return IDLE, "time limit"
            status = self._tick(self._overruns or self._engine)
            if status != RUNNING:
                return status, ""
            if self._clock.due > self._clock.now:
                self._pace.real = getattr(self._engine, "works_beside", False)
                self._advance(self._pace.sleep(self._period_left(), self._clock.due - self._clock.now))
        return IDLE, SUSPENDED if controls.suspends else "interrupted"

    def _tick(self, ticking: Ticked | Overruns) -> int:
        self._suspended = False
        if self._disabled and not getattr(self._engine, "idle", False):
            self._enable()
        self._clock.due = math.inf
        self._pace.tick_begins()
        status = ticking.tick()
        self.ticks += 1
        self._report_halts()
        if self.after_tick is not None:
            self.after_tick()
        return status

    def _stand_still(self, stepped: bool) -> None:
        """Spend one period of a pause. After a single step a simulated world stops as it is, so that steps add up."""
        robot = self._robot
        frozen = robot is None or not getattr(robot, "moves_by_itself", True)
        if not self._suspended and not (stepped and frozen):
            self._suspended = True
            self._engine.suspend()
            self._report_halts()
            if robot is not None:
                self._disable(robot)
                robot.step(self._period)
        elif robot is not None and (not frozen or (self._suspended and getattr(robot, "moving", False))):
            robot.step(self._period)
        else:
            self.controls.wait(None)
            return
        self._publish_period()
        self.controls.wait(self._pause)

    def _period_left(self) -> float:
        """Return the length of a period; the last one ends with the time limit."""
        left = self._began + self._limit - self._clock.now
        return min(self._period, left) if left > 0 else self._period

    def _advance(self, seconds: float) -> None:
        self._clock.advance(seconds)
        left, self._pace.stepped = seconds - self._pace.stepped, 0.0
        if self._robot is not None and left > 0:
            self._robot.step(left)
        self._publish_period()

    def _publish_period(self) -> None:
        self._bus.emit(PeriodPassed, self.ticks, self._pace.late, read_robot(self._robot), self._robot)

    def _end(self, suspends: bool = False) -> Standstill:
        """End the run. Another Ctrl-C cuts short only the wait for the robot, not the halting."""
        try:
            if suspends and not self.controls.emergency:
                self._engine.suspend()
            else:
                self._engine.halt(emergency=self.controls.emergency)
        finally:
            if self._robot is not None:
                self._disable(self._robot)
        unended = self._engine.close(_PATIENCE)
        self._report_halts()
        for failure in unended:
            self._report(failure, f"{failure.node.source_text} did not end after it was halted")
        if self._robot is None:
            return Standstill()
        rest_until, passed = self._clock.now + _REST, self._period
        while True:  # at least once: a robot that was stopped brakes with its next step
            self._advance(passed)
            standstill = standstill_of(self._robot)
            if not (standstill.alarming or standstill.early) or self._clock.now >= rest_until - 1e-9:
                return standstill
            passed = self._pace.rest(self._period)

    def _enable(self) -> None:
        """Enable the robot as a run begins, or goes on after a pause: the one place where a robot that was stopped gets
        to move again.
        """
        self._disabled = False
        if self._robot is not None:
            getattr(self._robot, "enable", _nothing)()
            if self.controls.emergency:  # it came meanwhile
                self._disable(self._robot)

    def _disable(self, robot: Robot) -> None:
        self._disabled = True
        disable(robot)

    def _report_halts(self) -> None:
        for failure in self._engine.take_halt_failures():
            self._report(failure, f"{failure.node.id} did not halt: {failure.reason}")

    def _report(self, failure: Failure, text: str) -> None:
        self._bus.emit(Troubled, text, failure.path, _place(failure))


def _place(failure: Failure) -> str:
    return failure.span.place if failure.span is not None else ""


def _nothing() -> None:
    """Do nothing, in place of what a robot does not have."""


def _ending(outcome: Outcome) -> tuple[Any, ...]:
    """Return the fields of Ended."""
    still, failure = outcome.standstill.still, outcome.failure
    data = NAMES[outcome.status], outcome.stopped, outcome.seconds, still, "" if still else str(outcome.standstill)
    if failure is None:
        return data
    return *data, failure.path, failure.node.id, failure.reason, _place(failure)

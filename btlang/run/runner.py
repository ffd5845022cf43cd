"""Runs a mission: ticks its tree at a fixed rate, moves the clock and the robot, and leaves the robot at rest."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping

from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine, Failure
from btlang.engine.leaf import LeafBinding
from btlang.engine.status import IDLE, NAMES, RUNNING
from btlang.record import Record
from btlang.run.controls import Controls
from btlang.run.events import EventStream, PeriodPassed, RobotEvent, StatusesChanged
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.watch import Changes
    from btlang.run.events import Robot


_REST = 2.0  # seconds of the mission that a robot gets to come to rest


class Outcome(Record):
    """How a run ended: `stopped` is "" where the tree completed, else (status IDLE) "time limit" or "interrupted".

    `seconds` are those of the mission, without the time in which the robot came to rest.
    """

    status: int
    seconds: float
    ticks: int
    failure: Failure | None
    stopped: str = ""


def traced_engine(
    tree: Tree,
    bind: Callable[[str], LeafBinding | None],
    *,
    clock: Clock,
    events: EventStream,
    services: Mapping[str, Any] = {},
    blackboard: Blackboard | None = None,
) -> Engine:
    """An engine whose status changes go into the stream."""

    def changed(changes: Changes) -> None:
        events.publish(StatusesChanged(clock.now, changes, engine))

    engine = Engine(tree, bind, clock=clock, services=services, blackboard=blackboard, listener=changed)
    events.before = engine.tell
    return engine


class Runner:
    """Ticks an engine `rate` times a second of the mission until the tree completes.

    `speed` is seconds of the mission per second of real time; math.inf does not wait at all. `overruns` counts the
    periods that took longer than they should have. Time after a late tick is not caught up with.

    A pause suspends the tree (see Engine.suspend) and brakes the robot. Then the time of the mission stands still, and
    so does a simulated world once the robot is at rest.
    """

    def __init__(
        self,
        engine: Engine,
        *,
        clock: Clock,
        robot: Robot | None = None,
        rate: float = 20.0,
        speed: float = 1.0,
        time_limit: float | None = None,
        events: EventStream | None = None,
        controls: Controls | None = None,
    ) -> None:
        self._engine = engine
        self._clock = clock
        self._robot = robot
        self._period = 1 / rate
        self._pause = self._period / speed
        self._limit = math.inf if time_limit is None else time_limit
        self._events = EventStream() if events is None else events
        self.controls = Controls() if controls is None else controls
        self._suspended = False
        self._began = clock.now
        self.ticks = 0
        self.overruns = 0

    def halt(self) -> None:
        """Halts the tree and stops the robot, outside of run(); the next tick starts the tree anew."""
        self._end()

    def tick(self) -> int:
        """One period: ticks the tree, then, unless it completed, moves clock and robot on. Returns the status."""
        self._suspended = False
        status = self._engine.tick()
        self.ticks += 1
        self._report_halts()
        if status == RUNNING:
            left = self._began + self._limit - self._clock.now  # the last period ends with the time limit
            self._advance(left if left > 0 else math.inf)
        return status

    def run(self) -> Outcome:
        """Runs to the end, the time limit, a stop or Ctrl-C; then halts the tree and brings the robot to rest.

        An exception other than KeyboardInterrupt does the same and comes through.
        """
        self._began, self.ticks = self._clock.now, 0
        self._publish_period()
        try:
            status, stopped = self._loop()
        except KeyboardInterrupt:
            status, stopped = IDLE, "interrupted"
        finally:
            seconds = self._clock.now - self._began
            self._end()
        outcome = Outcome(status, seconds, self.ticks, None if stopped else self._engine.failure, stopped)
        self._events.publish(RobotEvent(self._clock.now, "end", _ending(outcome)))
        return outcome

    def _loop(self) -> tuple[int, str]:
        controls, due, stepped = self.controls, time.monotonic(), False
        while not controls.stopped:
            if controls.paused and not controls.take_step():
                self._stand_still(stepped)
                due = time.monotonic()
                continue
            stepped = controls.paused
            if self._clock.now - self._began >= self._limit - 1e-9:
                return IDLE, "time limit"
            status = self.tick()
            if status != RUNNING:
                return status, ""
            due = self._wait(due + self._pause)
        return IDLE, "interrupted"

    def _stand_still(self, stepped: bool) -> None:
        """One period of a pause. After a single step a simulated world stops as it is, so that steps add up."""
        robot = self._robot
        frozen = robot is None or not getattr(robot, "moves_by_itself", True)
        if not self._suspended and not (stepped and frozen):
            self._suspended = True
            self._engine.suspend()
            self._report_halts()
            if robot is not None:
                robot.stop()
                robot.step(self._period)
        elif robot is not None and (not frozen or (self._suspended and getattr(robot, "moving", False))):
            robot.step(self._period)
        else:
            self.controls.wait(None)
            return
        self._publish_period()
        self.controls.wait(self._pause)

    def _wait(self, due: float) -> float:
        """Sleeps until a point in real time; returns it, or the present where that is later already."""
        if self._pause == 0:
            return due
        left = due - time.monotonic()
        if left <= 0:
            self.overruns += 1
            return due - left
        while left > 0 and not self.controls.stopped:
            self.controls.wait(left)
            left = due - time.monotonic()
        return due

    def _advance(self, most: float = math.inf) -> None:
        seconds = min(self._period, most)
        self._clock.advance(seconds)
        if self._robot is not None:
            self._robot.step(seconds)
        self._publish_period()

    def _publish_period(self) -> None:
        self._events.publish(PeriodPassed(self._clock.now, self.ticks, self.overruns, self._robot))

    def _end(self) -> None:
        """Another Ctrl-C cuts short only the wait for the robot, not the halting."""
        try:
            self._engine.halt()
        finally:
            if self._robot is not None:
                self._robot.stop()
        self._report_halts()
        if self._robot is None:
            return
        rest_until = self._clock.now + _REST
        while True:  # at least once: a robot that was stopped takes no command before its next step
            self._advance()
            if not getattr(self._robot, "moving", False) or self._clock.now >= rest_until - 1e-9:
                return
            if self._pause:
                time.sleep(self._pause)

    def _report_halts(self) -> None:
        for failure in self._engine.take_halt_failures():
            data = {"text": f"{failure.node.id} did not halt: {failure.reason}", "path": failure.path}
            self._events.publish(RobotEvent(self._clock.now, "error", data))


def _ending(outcome: Outcome) -> Mapping[str, Any]:
    """How a run ended, for programs."""
    data = {"outcome": NAMES[outcome.status], "stopped": outcome.stopped, "seconds": round(outcome.seconds, 6)}
    failure = outcome.failure
    if failure is None:
        return data
    place = {} if failure.span is None else {"place": failure.span.place}
    return {**data, "path": failure.path, "id": failure.node.id, "reason": failure.reason, **place}

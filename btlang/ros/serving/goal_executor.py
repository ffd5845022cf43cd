"""Goals of served actions: each is a leaf in its own engine, and the runner ticks all of them as one."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from btlang.backends.engine import bind_leaf
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.engine import Engine, EngineError
from btlang.engine.status import RUNNING, SUCCESS
from btlang.printer.phrase import phrase_of
from btlang.robots.command_gate import RobotProxy
from btlang.ros.serving.names import WORD
from btlang.run.outcome import standstill_of
from btlang.run.runner import trace_engine
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    from btlang.engine.engine import Failure
    from btlang.run.connection import Connection
    from btlang.vocabulary.lexicon import Lexicon

    class Caller(Protocol):
        """The client that sent a goal."""

        def report(self, share: float, state: str) -> object:
            """Report the progress, from 0 to 1, and the current command."""

        def end(self, success: bool, reason: str) -> object:
            """End the goal; `reason` is why it failed."""


_PAUSE = 0.1  # seconds of the mission between two words to the caller
_PATIENCE = 0.2  # real seconds that background leaves get to end after a halt, in which nothing else is ticked
BUSY = 0.5
"""Real seconds that a goal waits for a busy resource: the request that cancels the other goal
may come a moment later.
"""
REST = 2.0
"""Seconds of the mission that a robot gets to come to rest before the end of a cancelled goal is reported."""


class LeafGoal:
    """A goal, done by one leaf. Any thread may set `cancelled`, the reason; everything else is for the thread that
    ticks.

    `reason` is None until the goal is over, then "" or why it failed.
    """

    def __init__(
        self, node: Node, caller: Caller, connection: Connection, vocabulary: Lexicon, patient_until: float
    ) -> None:
        self.cancelled = ""
        self.reason: str | None = None
        self.engine: Engine | None = None
        self.patient_until = patient_until
        """The real time until which it waits for a busy resource."""
        self.ended = connection.bus.clock.now
        self.words = phrase_of(node, vocabulary)
        self.resources = frozenset(r for entry in vocabulary.entries[node.id] for r in entry.resources)
        self._node, self._caller, self._connection, self._vocabulary = node, caller, connection, vocabulary
        self._news = (0.0, self.words)
        self._reported: tuple[float, str] | None = None
        self._reported_at = connection.bus.clock.now
        self._repeats_at = 0.0

    @property
    def running(self) -> bool:
        """Whether it has begun and isn't over."""
        return self.engine is not None and self.reason is None

    def start(self, wake: Callable[[], object]) -> None:
        """Begin with the next `tick`. The goal is over if the leaf can't run."""
        connection, vocabulary = self._connection, self._vocabulary
        try:
            self.engine = trace_engine(
                Tree(self._node),
                lambda node_id: bind_leaf(node_id, vocabulary, connection.bind),
                bus=connection.bus,
                services={"robot": connection.robot, "progress": self._progress},
                proxies={"robot": RobotProxy},
            )
            self.engine.on_wake = wake
        except EngineError as error:
            self.end(error.message)
        except MissionError as error:
            self.end(str(error))

    def tick(self) -> None:
        """Tick the leaf."""
        assert self.engine is not None
        self._connection.bus.before = self.engine.flush  # all engines publish into the same stream
        status = self.engine.tick()
        if status == RUNNING:
            self.report()
            return
        failure = self.engine.failure
        self.engine.close()
        self.end("" if status == SUCCESS else failure.reason if failure is not None else "it had nothing to do")

    def halt(self, reason: str, emergency: bool = False) -> None:
        """End the goal for a reason, unless it is over."""
        if self.reason is not None:
            return
        left = False
        if self.engine is not None:
            self.engine.halt(emergency)
            left = bool(self.engine.close(_PATIENCE))
        self.end(f"{reason}, and it did not end after it was halted" if left else reason)

    def end(self, reason: str) -> None:
        """End the goal; the caller doesn't know yet."""
        self.reason, self.ended = reason, self._connection.bus.clock.now

    def report(self, waits_for: str = "") -> None:
        """Report progress to the caller, and now and then that the goal still goes on."""
        news, now = (0.0, waits_for) if waits_for else self._news, self._connection.bus.clock.now
        is_new = news != self._reported and (self._reported is None or now - self._reported_at >= _PAUSE)
        if is_new or time.monotonic() >= self._repeats_at:
            self._reported, self._reported_at, self._repeats_at = news, now, time.monotonic() + WORD
            self._caller.report(*news)

    def answer(self) -> None:
        """Report to the caller how it ended."""
        self._caller.end(self.reason == "", self.reason or "")

    def _progress(self, share: float, state: str = "") -> None:
        self._news = max(0.0, min(1.0, float(share))), state or self.words


class GoalExecutor:
    """All goals as one thing that a run can tick. `begin` is for any thread, everything else for the one that ticks.

    Goals that need the same resource of the robot don't run at the same time: the later one fails. See
    `btlang.run.runner.Ticked`. `now` gives real seconds.
    """

    failure = None

    def __init__(self, connection: Connection, vocabulary: Lexicon, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self.on_wake: Callable[[], object] | None = None
        self._connection, self._vocabulary = connection, vocabulary
        self._new: deque[LeafGoal] = deque()
        self._goals: list[LeafGoal] = []
        self._halt_failures: list[Failure] = []

    def begin(self, node: Node, caller: Caller) -> Callable[[str], None]:
        """Take on a goal; return a function that cancels it, for a reason."""
        goal = LeafGoal(node, caller, self._connection, self._vocabulary, self._now() + BUSY)
        self._new.append(goal)
        self._wake()

        def cancel(reason: str) -> None:
            goal.cancelled = reason
            self._wake()

        return cancel

    @property
    def idle(self) -> bool:
        """Whether there are no goals."""
        return not (self._new or self._goals)

    def tick(self) -> int:
        """Tick all goals. Returns RUNNING, also without goals."""
        while self._new:
            self._goals.append(self._new.popleft())
        for goal in self._goals:  # all of them before one begins that needs what they used
            if goal.cancelled:
                self._halt(goal, goal.cancelled)
        for goal in self._goals:
            if goal.reason is None and (goal.running or self._starts(goal)):
                goal.tick()
        self._answer(self._at_rest)
        return RUNNING

    def halt(self, emergency: bool = False) -> None:
        """Halt all goals. New ones never begin."""
        while self._new:
            self._goals.append(self._new.popleft())
        for goal in self._goals:
            self._halt(goal, "emergency stop" if emergency else "the server was stopped", emergency)

    def suspend(self) -> None:
        """Halt: a server can't be paused."""
        self.halt()

    def take_halt_failures(self) -> list[Failure]:
        """Return what leaves raised when they were halted, since the last call."""
        failures, self._halt_failures = self._halt_failures, []
        return failures

    def close(self, patience: float = 0.0) -> list[Failure]:
        """Do nothing: each goal waits for its leaf when it is halted."""
        return []

    def answer_all(self) -> None:
        """Report the end of each goal that is over."""
        self._answer(lambda goal: True)

    def _wake(self) -> None:
        if self.on_wake is not None:
            self.on_wake()

    def _starts(self, goal: LeafGoal) -> bool:
        """Begin a goal if nothing is in its way; return whether it began."""
        for other in self._goals:
            shared = sorted(goal.resources & other.resources) if other.running else ()
            if shared:
                if self._now() < goal.patient_until:
                    goal.report(f"waits for the {shared[0]}")
                else:
                    goal.end(f"'{other.words}' is using the {shared[0]}")
                return False
        goal.start(self._wake)
        return goal.running

    def _halt(self, goal: LeafGoal, reason: str, emergency: bool = False) -> None:
        engine = goal.engine if goal.running else None
        goal.halt(reason, emergency)
        if engine is not None:
            self._halt_failures += engine.take_halt_failures()

    def _at_rest(self, goal: LeafGoal) -> bool:
        """Return whether the end of a goal may be reported. A goal that replaced a cancelled one keeps the robot
        moving.
        """
        if not goal.cancelled or goal.engine is None or goal.reason == "":
            return True
        taken_over = any(other.running and other.resources & goal.resources for other in self._goals)
        if taken_over:
            return True
        standstill = standstill_of(self._connection.robot)
        if not standstill.alarming:
            return True
        if self._connection.bus.clock.now - goal.ended < REST:
            return False
        goal.reason = f"{goal.reason}; {standstill}"
        return True

    def _answer(self, may: Callable[[LeafGoal], bool]) -> None:
        for goal in [goal for goal in self._goals if goal.reason is not None and may(goal)]:
            self._goals.remove(goal)
            goal.answer()

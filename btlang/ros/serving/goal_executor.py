"""All goals that go on, ticked as one: what the runner runs in place of a mission."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from btlang.engine.status import RUNNING
from btlang.ros.serving.goal import Goal
from btlang.run.outcome import standstill_of
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.engine import Failure
    from btlang.ros.serving.goal import Caller
    from btlang.run.connection import Connection
    from btlang.vocabulary.lexicon import Lexicon

BUSY = 0.5
"""Real seconds that a goal waits for what another one uses: the word that cancels that one may come a moment later."""
REST = 2.0
"""Seconds of the mission that a robot gets to come to rest before the end of a cancelled goal is reported."""


class GoalExecutor:
    """Each goal is one leaf. `begin` may be called from any thread, all else by the one that ticks.

    Goals that need the same resource of the robot do not run at the same time: the later one fails. See
    `btlang.run.runner.Ticked`. `now` gives real seconds.
    """

    failure = None

    def __init__(self, connection: Connection, vocabulary: Lexicon, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self.on_wake: Callable[[], object] | None = None
        self._connection, self._vocabulary = connection, vocabulary
        self._new: deque[Goal] = deque()
        self._goals: list[Goal] = []
        self._halt_failures: list[Failure] = []

    def begin(self, node: Node, caller: Caller) -> Callable[[str], None]:
        """Takes on a goal; returns what cancels it, for a reason."""
        goal = Goal(node, caller, self._connection, self._vocabulary, self._now() + BUSY)
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
        """Goes on with all goals. RUNNING, also where there are none."""
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
        """Halts all goals. Those that are new never begin."""
        while self._new:
            self._goals.append(self._new.popleft())
        for goal in self._goals:
            self._halt(goal, "emergency stop" if emergency else "the server was stopped", emergency)

    def suspend(self) -> None:
        """As `halt`: nobody pauses a server."""
        self.halt()

    def take_halt_failures(self) -> list[Failure]:
        """What leaves raised while they were halted since it was last asked."""
        failures, self._halt_failures = self._halt_failures, []
        return failures

    def close(self, patience: float = 0.0) -> list[Failure]:
        """Nothing is left: each goal waits for its leaf when it is halted."""
        return []

    def answer_all(self) -> None:
        """Reports the end of each goal that is over."""
        self._answer(lambda goal: True)

    def _wake(self) -> None:
        if self.on_wake is not None:
            self.on_wake()

    def _starts(self, goal: Goal) -> bool:
        """Begins a goal where nothing is in its way."""
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

    def _halt(self, goal: Goal, reason: str, emergency: bool = False) -> None:
        engine = goal.engine if goal.running else None
        goal.halt(reason, emergency)
        if engine is not None:
            self._halt_failures += engine.take_halt_failures()

    def _at_rest(self, goal: Goal) -> bool:
        """Whether the end of a goal may be reported. One that took over from a cancelled one moves the robot on."""
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

    def _answer(self, may: Callable[[Goal], bool]) -> None:
        for goal in [goal for goal in self._goals if goal.reason is not None and may(goal)]:
            self._goals.remove(goal)
            goal.answer()

"""All goals that go on, ticked as one: what the runner runs in place of a mission."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from btlang.engine.status import RUNNING
from btlang.ros.serving.job import Job
from btlang.run.standstill import standstill_of
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.engine import Failure
    from btlang.ros.serving.job import Caller
    from btlang.run.connection import Connection
    from btlang.vocabulary.vocabulary import Vocabulary

BUSY = 0.5
"""Real seconds that a goal waits for what another one uses: the word that cancels that one may come a moment later."""
REST = 2.0
"""Seconds of the mission that a robot gets to come to rest before the end of a cancelled goal is told."""


class Work:
    """Each goal is one leaf. `begin` may be called from any thread, all else by the one that ticks.

    Goals that need the same resource of the robot do not run at the same time: the later one fails. See
    `btlang.run.runner.Ticked`. `now` gives real seconds.
    """

    failure = None

    def __init__(
        self, connection: Connection, vocabulary: Vocabulary, now: Callable[[], float] = time.monotonic
    ) -> None:
        self._now = now
        self.on_wake: Callable[[], object] | None = None
        self._connection, self._vocabulary = connection, vocabulary
        self._new: deque[Job] = deque()
        self._jobs: list[Job] = []
        self._halt_failures: list[Failure] = []

    def begin(self, node: Node, caller: Caller) -> Callable[[str], None]:
        """Takes on a goal; returns what cancels it, for a reason."""
        job = Job(node, caller, self._connection, self._vocabulary, self._now() + BUSY)
        self._new.append(job)
        self._wake()

        def cancel(reason: str) -> None:
            job.cancelled = reason
            self._wake()

        return cancel

    @property
    def idle(self) -> bool:
        """Whether there are no goals."""
        return not (self._new or self._jobs)

    def tick(self) -> int:
        """Goes on with all goals. RUNNING, also where there are none."""
        while self._new:
            self._jobs.append(self._new.popleft())
        for job in self._jobs:  # all of them before one begins that needs what they used
            if job.cancelled:
                self._halt(job, job.cancelled)
        for job in self._jobs:
            if job.reason is None and (job.running or self._starts(job)):
                job.tick()
        self._answer(self._at_rest)
        return RUNNING

    def halt(self, emergency: bool = False) -> None:
        """Halts all goals. Those that are new never begin."""
        while self._new:
            self._jobs.append(self._new.popleft())
        for job in self._jobs:
            self._halt(job, "emergency stop" if emergency else "the server was stopped", emergency)

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
        """Tells the end of each goal that is over."""
        self._answer(lambda job: True)

    def _wake(self) -> None:
        if self.on_wake is not None:
            self.on_wake()

    def _starts(self, job: Job) -> bool:
        """Begins a goal where nothing is in its way."""
        for other in self._jobs:
            shared = sorted(job.resources & other.resources) if other.running else ()
            if shared:
                if self._now() < job.patient_until:
                    job.tell(f"waits for the {shared[0]}")
                else:
                    job.end(f"'{other.words}' is using the {shared[0]}")
                return False
        job.start(self._wake)
        return job.running

    def _halt(self, job: Job, reason: str, emergency: bool = False) -> None:
        engine = job.engine if job.running else None
        job.halt(reason, emergency)
        if engine is not None:
            self._halt_failures += engine.take_halt_failures()

    def _at_rest(self, job: Job) -> bool:
        """Whether the end of a goal may be told. One that took over from a cancelled one moves the robot on."""
        if not job.cancelled or job.engine is None or job.reason == "":
            return True
        taken_over = any(other.running and other.resources & job.resources for other in self._jobs)
        if taken_over:
            return True
        standstill = standstill_of(self._connection.robot)
        if not standstill.alarming:
            return True
        if self._connection.bus.clock.now - job.ended < REST:
            return False
        job.reason = f"{job.reason}; {standstill}"
        return True

    def _answer(self, may: Callable[[Job], bool]) -> None:
        for job in [job for job in self._jobs if job.reason is not None and may(job)]:
            self._jobs.remove(job)
            job.answer()

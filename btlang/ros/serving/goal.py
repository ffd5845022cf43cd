"""One goal: the leaf that does it, in an engine of its own."""

from __future__ import annotations

import time

from btlang.backends.engine import bind_leaf
from btlang.diagnostics.errors import MissionError
from btlang.engine.engine import Engine, EngineError
from btlang.engine.status import RUNNING, SUCCESS
from btlang.printer.phrase import phrase_of
from btlang.robots.proxy import RobotProxy
from btlang.ros.serving.names import WORD
from btlang.run.runner import trace_engine
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Protocol

    from btlang.run.connection import Connection
    from btlang.vocabulary.lexicon import Lexicon

    class Caller(Protocol):
        """Who has sent the goal."""

        def report(self, share: float, state: str) -> object:
            """How much is done, from 0 to 1, and what it does now."""

        def end(self, success: bool, reason: str) -> object:
            """It is over; `reason` says why it failed."""


_PAUSE = 0.1  # seconds of the mission between two words to the caller
_PATIENCE = 0.2  # real seconds that background leaves get to end after a halt, in which nothing else is ticked


class Goal:
    """`cancelled`, why it is, may be set by any thread; all else is for the one that ticks.

    `reason` is None as long as it is not over, then "" or why it failed.
    """

    def __init__(
        self, node: Node, caller: Caller, connection: Connection, vocabulary: Lexicon, patient_until: float
    ) -> None:
        self.cancelled = ""
        self.reason: str | None = None
        self.engine: Engine | None = None
        self.patient_until = patient_until
        """The real time until which it waits for what another one uses."""
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
        """Whether it has begun and is not over."""
        return self.engine is not None and self.reason is None

    def start(self, wake: Callable[[], object]) -> None:
        """Begins with the next `tick`. It is over where the leaf cannot run."""
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
        """Goes on."""
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
        """Ends it for a reason, unless it is over."""
        if self.reason is not None:
            return
        left = False
        if self.engine is not None:
            self.engine.halt(emergency)
            left = bool(self.engine.close(_PATIENCE))
        self.end(f"{reason}, and it did not end after it was halted" if left else reason)

    def end(self, reason: str) -> None:
        """It is over; the caller does not know yet."""
        self.reason, self.ended = reason, self._connection.bus.clock.now

    def report(self, waits_for: str = "") -> None:
        """Reports to the caller what is new, and now and then that it still goes on."""
        news, now = (0.0, waits_for) if waits_for else self._news, self._connection.bus.clock.now
        is_new = news != self._reported and (self._reported is None or now - self._reported_at >= _PAUSE)
        if is_new or time.monotonic() >= self._repeats_at:
            self._reported, self._reported_at, self._repeats_at = news, now, time.monotonic() + WORD
            self._caller.report(*news)

    def answer(self) -> None:
        """Reports to the caller how it ended."""
        self._caller.end(self.reason == "", self.reason or "")

    def _progress(self, share: float, state: str = "") -> None:
        self._news = max(0.0, min(1.0, float(share))), state or self.words

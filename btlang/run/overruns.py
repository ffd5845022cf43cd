"""Ticks that take longer than their period, and which leaf is to blame."""

from __future__ import annotations

from time import perf_counter

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.timing import Stopwatch
from btlang.run.events import EventStream, Overrun

_TO_BLAME = 0.5  # of a period: a leaf that took less is not the reason, the computer was busy with something else
_NOISE = 0.02  # seconds that anything may take on a busy computer


class Overruns:
    """Ticks an engine that was made with a stopwatch, and tells of each tick that took too long.

    `period` is in seconds of real time. `count` is the number of such ticks, `worst` the one with the slowest leaf.
    """

    def __init__(self, engine: Engine, stopwatch: Stopwatch, period: float, clock: Clock, events: EventStream) -> None:
        self._engine = engine
        self._stopwatch = stopwatch
        self._period = period
        self._clock = clock
        self._events = events
        self.count = 0
        self.worst: Overrun | None = None

    def tick(self) -> int:
        """Ticks the engine; returns its status."""
        self._stopwatch.spent.clear()
        began = perf_counter()
        status = self._engine.tick()
        seconds = perf_counter() - began
        if seconds > self._period:
            self._tell(seconds)
        return status

    def _tell(self, seconds: float) -> None:
        overrun = Overrun(self._clock.now, seconds, self._period)
        slowest = self._stopwatch.slowest()
        if slowest is not None and slowest[1] > max(_TO_BLAME * self._period, _NOISE):
            index, spent = slowest
            overrun = overrun.replace(path=self._engine.path(index), node=self._engine.node(index), leaf_seconds=spent)
        self.count += 1
        if overrun.node is not None and (self.worst is None or overrun.leaf_seconds > self.worst.leaf_seconds):
            self.worst = overrun
        self._events.publish(overrun)

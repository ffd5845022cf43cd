"""Ticks that take longer than their period, and which leaf is to blame."""

from __future__ import annotations

from time import perf_counter

from btlang.engine.engine import Engine
from btlang.engine.timing import Stopwatch
from btlang.run.bus import Bus
from btlang.run.events import Overrun
from btlang.tree.node import Node

_TO_BLAME = 0.5  # of a period: a leaf that took less is not the reason, the computer was busy with something else
_NOISE = 0.02  # seconds that anything may take on a busy computer


def are_many(overruns: int, ticks: int) -> bool:
    """Whether several ticks took too long, and more than one in a hundred: fewer are of no interest to people."""
    return overruns > 1 and overruns * 100 > ticks


class Overruns:
    """Ticks an engine that was made with a stopwatch, and reports each tick that took too long.

    `period` is in seconds of real time. `count` is the number of such ticks, `worst` the slowest leaf in one of
    them and its seconds.
    """

    def __init__(self, engine: Engine, stopwatch: Stopwatch, period: float, bus: Bus) -> None:
        self._engine = engine
        self._stopwatch = stopwatch
        self._period = period
        self._bus = bus
        self.count = 0
        self.worst: tuple[Node, float] | None = None

    def tick(self) -> int:
        """Ticks the engine; returns its status."""
        self._stopwatch.spent.clear()
        began = perf_counter()
        status = self._engine.tick()
        seconds = perf_counter() - began
        if seconds > self._period:
            self._report(seconds)
        return status

    def _report(self, seconds: float) -> None:
        self.count += 1
        slowest = self._stopwatch.slowest()
        if slowest is None or slowest[1] <= max(_TO_BLAME * self._period, _NOISE):
            self._bus.emit(Overrun, seconds, self._period)
            return
        index, spent = slowest
        node = self._engine.node(index)
        if self.worst is None or spent > self.worst[1]:
            self.worst = node, spent
        self._bus.emit(Overrun, seconds, self._period, self._engine.path(index), node, spent)

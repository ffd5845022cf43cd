"""A run in real time: when the next tick is due, and ticks that take longer than their period."""

from __future__ import annotations

import math
import time
from time import perf_counter

from btlang.engine.clock import LeafTimer
from btlang.engine.engine import Engine
from btlang.run.bus import Bus
from btlang.run.controls import Controls
from btlang.run.events import Overrun
from btlang.tree.node import Node


class Pace:
    """The pace of a run: it sleeps between ticks.

    `speed` is seconds of the mission per second of real time; math.inf does not sleep at all.

    `late` counts the periods that were over before their sleep began. Time after a late tick is not caught up with.
    While it is `real`, what would not sleep at all keeps step with real time: something works beside the mission.
    """

    def __init__(self, speed: float, controls: Controls) -> None:
        self._speed = speed
        self._controls = controls
        self._due = 0.0
        self._woken = False
        self.late = 0
        self.stepped = 0.0
        """The seconds of the latest sleep for which the robot was already stepped; who steps it sets it to 0."""
        self.real = False
        self._kept_step = speed < math.inf

    def begin(self) -> None:
        """Begin a period now."""
        self._due = time.monotonic()

    def tick_begins(self) -> None:
        """Begin a tick: whoever calls `wake` from now on means the tick after this one."""
        self._woken = False

    def wake(self) -> None:
        """End the sleep, also one that begins before the next tick; from any thread."""
        self._woken = True
        self._controls.wake()

    def rest(self, seconds: float) -> float:
        """Sleep as `sleep` does, whatever is asked for meanwhile: for the time after a run, in which the robot comes to
        rest.
        """
        if self._speed < math.inf:
            time.sleep(seconds / self._speed)
        return seconds

    def sleep(self, period: float, wait: float = math.inf) -> float:
        """Sleep through a period of so many seconds of the mission; return how many have passed.

        Those are all of them unless it is to `wait` less from the tick's beginning on, is woken, or the run is stopped.
        """
        seconds, speed = min(period, wait), self._speed
        if speed == math.inf:
            if not self.real:
                self._kept_step = False
                return seconds
            speed = 1.0
            if not self._kept_step:
                self.begin()
                self._kept_step = True
        began, now = self._due, time.monotonic()
        self._due += seconds / speed
        if now >= began + period / speed:
            self.late += 1
            self._due = now
            return period
        if now > self._due:
            self._due = now
            return (now - began) * speed
        while (left := self._due - now) > 0:
            if self._woken or self._controls.stopped:
                self._due = now
                return max(0.0, seconds - left * speed)
            self._controls.wait(left)
            now = time.monotonic()
        return seconds


_TO_BLAME = 0.5  # of a period: a leaf that took less is not the reason, the computer was busy with something else
_NOISE = 0.02  # seconds that anything may take on a busy computer


def are_many(overruns: int, ticks: int) -> bool:
    """Return whether several ticks took too long, and more than one in a hundred: fewer are of no interest to
    people.
    """
    return overruns > 1 and overruns * 100 > ticks


class Overruns:
    """A ticker of an engine that was made with a stopwatch, which reports each tick that took too long.

    `period` is in seconds of real time. `count` is the number of such ticks, `worst` the slowest leaf in one of them
    and its seconds. A leaf that took less than `allowed` seconds isn't to blame.
    """

    def __init__(self, engine: Engine, stopwatch: LeafTimer, period: float, bus: Bus, allowed: float = 0.0) -> None:
        self._engine = engine
        self._stopwatch = stopwatch
        self._period = period
        self._bus = bus
        self._allowed = max(_TO_BLAME * period, _NOISE, allowed)
        self.count = 0
        self.worst: tuple[Node, float] | None = None

    def tick(self) -> int:
        """Tick the engine; return its status."""
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
        if slowest is None or slowest[1] <= self._allowed:
            self._bus.emit(Overrun, seconds, self._period)
            return
        index, spent = slowest
        node = self._engine.node(index)
        if self.worst is None or spent > self.worst[1]:
            self.worst = node, spent
        self._bus.emit(Overrun, seconds, self._period, self._engine.path(index), node, spent)

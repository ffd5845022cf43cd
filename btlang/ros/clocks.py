"""Clocks of a ROS 2 robot: real time in which this process ran, time that always goes on, and the pace of a run."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from threading import RLock

from btlang.run.controls import Controls
from btlang.run.pace import Pace

HEARTBEAT = 0.2
"""Seconds after which each node looks at the clock, so that a longer pause was none of the tick's."""
_ASLEEP = 1.5  # seconds in which no thread looks
STANDING = 1.0
"""Real seconds for which a clock may stand still, as that of a simulator does between its ticks."""
_SLOWEST = 100.0  # a clock that goes on more slowly than a hundredth of real time stands still
_LEAP, _FASTEST = 10.0, 1000.0  # seconds that a clock may be ahead of a look, and how often as fast it may be
_LOOK = 0.01  # seconds between two looks
_SLOW = 6.0  # how often as long as it says the time after a run may take: a simulator may be slow
_ENDING = 1.0  # real seconds that it may take in sum where the clock has failed
_CLOCK_LOOK = 0.002  # seconds between two looks at a clock that may run faster than the system's


def _real() -> float:
    """Return seconds of real time, including those of a suspended computer if the system reports them."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) if hasattr(time, "CLOCK_BOOTTIME") else time.monotonic()


class AwakeClock:
    """A clock that stands still while this process sleeps; for any thread and for signal handlers.

    Naps are noticed while some node watches for them.
    """

    def __init__(self, real: Callable[[], float] = _real) -> None:
        self.naps = 0
        """How often the process was asleep."""
        self.nap = 0.0
        """The seconds of the last nap."""
        self._real = real
        self._lock = RLock()
        self._seen, self._slept, self._woke = real(), 0.0, -math.inf
        self._watchers = 0

    def watch(self) -> None:
        """Count a watcher, which calls `now` with each heartbeat from now on."""
        with self._lock:
            self.now()
            self._watchers += 1

    def unwatch(self) -> None:
        """End one `watch`."""
        with self._lock:
            self._watchers -= 1

    def now(self) -> float:
        """Return the seconds for which this process has run."""
        with self._lock:
            real = self._real()
            gap, self._seen = real - self._seen, real
            if gap > _ASLEEP and self._watchers:
                self._slept += gap
                self.nap, self.naps, self._woke = gap, self.naps + 1, real - self._slept
            return real - self._slept

    def since_woke(self) -> float:
        """Return the seconds since the last nap; infinite if there was none."""
        return self.now() - self._woke


AWAKE = AwakeClock()
"""The clock of this process."""


class SteadyTime:
    """Seconds that follow the clock `read` and never go back; for any thread.

    A clock may stand still, run backwards or leap, and two programs may publish it in turn. Only steps forward are
    counted. After STANDING seconds without one, time goes on with the computer's clock until the other clock steps
    forward again, as that of a restarted simulator does. So every wait ends. `said` is called once with each thing that
    a clock shouldn't do.
    """

    def __init__(self, read: Callable[[], float], said: Callable[[str], object] = str) -> None:
        self._read, self._said = read, said
        self._warned: set[str] = set()
        self.has_failed = False
        """Whether the clock has done something that a clock shouldn't do."""
        now = read()
        # what the clock said and when, how long it has stood still, and the time that was made of it; replaced as one
        self._seen: tuple[float, float, float, float] = now, time.monotonic(), 0.0, now

    def now(self) -> float:
        """Return the seconds that have passed."""
        before, looked, stood, now = self._seen
        clock, real = self._read(), time.monotonic()
        elapsed, step = real - looked, clock - before
        leaps = step > _LEAP + _FASTEST * elapsed and before != 0.0  # where a node's clock is until its first message
        if step > 0.0 and not leaps:
            now += step
            stood = max(0.0, stood + elapsed - _SLOWEST * step)
            before = clock
        else:
            stood += elapsed
        if stood > STANDING:
            now += min(elapsed, stood - STANDING)
            before = clock
            if stood - elapsed <= STANDING:
                self._warn("leaps" if leaps else "runs backwards" if step < 0.0 else "stands still")
        self._seen = before, real, stood, now
        return now

    def _warn(self, what: str) -> None:
        self.has_failed = True
        if what not in self._warned:
            self._warned.add(what)
            self._said(what)


def wait_until(holds: Callable[[], object], limit: float) -> None:
    """Block until something holds, for at most `limit` real seconds. It is checked at least once."""
    until = time.monotonic() + limit
    while not holds() and time.monotonic() < until:
        time.sleep(_LOOK)


class RosPace(Pace):
    """The pace of a run by a simulator's clock `now`, or by that of the system (None).

    `sleep` returns all the time since the previous sleep, the tick included. A simulator's clock may do anything (see
    SteadyTime): the mission still ticks, its leaves find out what is wrong, and it ends. `said` is called once with
    each thing that the clock shouldn't do.
    """

    def __init__(
        self, controls: Controls, now: Callable[[], float] | None = None, said: Callable[[str], object] = str
    ) -> None:
        super().__init__(1.0, controls)
        self._steady = None if now is None else SteadyTime(now, said)
        self._time = time.monotonic if self._steady is None else self._steady.now
        self._look = math.inf if now is None else _CLOCK_LOOK
        self._last = 0.0
        self._spare = STANDING / 2  # real seconds that the time after a run may take beyond _SLOW
        self._rested = 0.0  # real seconds that it has taken

    def begin(self) -> None:
        """Begin a period now."""
        self._last = self._due = self._time()

    def sleep(self, period: float, wait: float = math.inf) -> float:
        """Sleep as Pace does; return the seconds that have passed."""
        now = self._time()
        if now >= self._due + period:
            self.late += 1
        self._due = max(now, min(self._due + period, self._last + wait))
        while now < self._due and not self._woken and not self._controls.stopped:
            self._controls.wait(min(self._due - now, self._look))
            now = self._time()
        self._due = min(self._due, now)
        passed, self._last = now - self._last, now
        return passed

    def rest(self, seconds: float) -> float:
        """Sleep like `sleep`, whatever is requested meanwhile.

        Doesn't wait for a clock that stands still or is much too slow, and waits at most a second in total for one that
        has failed.
        """
        begin, began = self._time(), time.monotonic()
        allowed, took = self._spare + _SLOW * seconds, 0.0
        while (passed := self._time() - begin) < seconds and took < min(allowed, self._left()):
            time.sleep(min(seconds - passed, self._look))
            took = time.monotonic() - began
        self._rested += took
        self._spare = min(STANDING / 2, allowed - took)
        return max(passed, seconds)

    def _left(self) -> float:
        """Return the real seconds that the time after a run may still take."""
        return _ENDING - self._rested if self._steady is not None and self._steady.has_failed else math.inf

"""Real time in which this process ran. A laptop with its lid closed, or a process that is stopped, hears nothing."""

from __future__ import annotations

import math
import time
from threading import RLock

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

HEARTBEAT = 0.2
"""Seconds after which each node looks at the clock, so that a longer pause was none of the tick's."""
_ASLEEP = 1.5  # seconds in which no thread looks


def _real() -> float:
    """Seconds of real time; those of a suspended computer count if the system reports them."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) if hasattr(time, "CLOCK_BOOTTIME") else time.monotonic()


class AwakeClock:
    """May be read from any thread, and from handlers of signals. Naps are noticed while some node watches for them."""

    def __init__(self, real: Callable[[], float] = _real) -> None:
        self.naps = 0
        """How often it was asleep."""
        self.nap = 0.0
        """For how many seconds the last time."""
        self._real = real
        self._lock = RLock()
        self._seen, self._slept, self._woke = real(), 0.0, -math.inf
        self._watchers = 0

    def watch(self) -> None:
        """From now on somebody calls `now` with each heartbeat."""
        with self._lock:
            self.now()
            self._watchers += 1

    def unwatch(self) -> None:
        """Nobody does so any more, for one call of `watch`."""
        with self._lock:
            self._watchers -= 1

    def now(self) -> float:
        """Seconds that go on only while this process runs."""
        with self._lock:
            real = self._real()
            gap, self._seen = real - self._seen, real
            if gap > _ASLEEP and self._watchers:
                self._slept += gap
                self.nap, self.naps, self._woke = gap, self.naps + 1, real - self._slept
            return real - self._slept

    def since_woke(self) -> float:
        """Seconds since it was asleep; infinite where it never was."""
        return self.now() - self._woke


AWAKE = AwakeClock()
"""That of this process."""

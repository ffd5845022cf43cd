"""The pace of a run on a ROS 2 robot: time passes by itself, and the mission's clock follows it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from btlang.ros.steady_time import STANDING, SteadyTime
from btlang.run.controls import Controls
from btlang.run.pace import Pace

_SLOW = 6.0  # how often as long as it says the time after a run may take: a simulator may be slow
_ENDING = 1.0  # real seconds that it may take in sum where the clock has failed
_LOOK = 0.002  # seconds between two looks at a clock that may run faster than the system's


class RosPace(Pace):
    """Sleeps by a simulator's clock `now`, or by that of the system (None).

    What `sleep` returns is all the time since the sleep before it, the tick included. A simulator's clock may do what
    it likes (see SteadyTime): the mission still ticks, its leaves find out what is wrong, and it ends. `said` is called
    once with each thing that the clock should not do.
    """

    def __init__(
        self, controls: Controls, now: Callable[[], float] | None = None, said: Callable[[str], object] = str
    ) -> None:
        super().__init__(1.0, controls)
        self._steady = None if now is None else SteadyTime(now, said)
        self._time = time.monotonic if self._steady is None else self._steady.now
        self._look = math.inf if now is None else _LOOK
        self._last = 0.0
        self._spare = STANDING / 2  # real seconds that the time after a run may take beyond _SLOW
        self._rested = 0.0  # real seconds that it has taken

    def begin(self) -> None:
        """A period begins now."""
        self._last = self._due = self._time()

    def sleep(self, period: float, wait: float = math.inf) -> float:
        """Sleeps as Pace does; returns the seconds that have passed."""
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
        """As `sleep`, whatever is asked for meanwhile. Waits for no clock that stands still or is much too slow, and a
        second in sum for one that has failed.
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
        """Real seconds that the time after a run may still take."""
        return _ENDING - self._rested if self._steady is not None and self._steady.has_failed else math.inf

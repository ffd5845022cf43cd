"""The pace of a run on a ROS 2 robot: time passes by itself, and the mission's clock follows it."""

from __future__ import annotations

import math
from collections.abc import Callable
from time import monotonic, sleep

from btlang.run.controls import Controls
from btlang.run.pace import Pace

_STANDING = 2.0  # seconds of real time after which a clock that stands still is not waited for any more
_LOOK = 0.002  # seconds between two looks at a clock that may run faster than the system's


class RosPace(Pace):
    """Sleeps by `now`: seconds of the system's clock, or of a simulator's.

    What `sleep` returns is all the time since the sleep before it, the tick included. A clock that stands still, as
    that of a simulator that has died, is not waited for without end: time goes on with the system's clock, so that the
    mission still ticks and its leaves find out what is wrong.
    """

    def __init__(self, controls: Controls, now: Callable[[], float]) -> None:
        super().__init__(1.0, controls)
        self._now = now
        self._look = math.inf if now is monotonic else _LOOK
        self._last = 0.0
        self._seen, self._looked = now(), monotonic()
        self._stands = 0.0
        self._more = 0.0  # how far the time of the mission is ahead of `now`

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
        """As `sleep`, whatever is asked for meanwhile."""
        begin = now = self._time()
        while now < begin + seconds:
            sleep(min(begin + seconds - now, self._look))
            now = self._time()
        return now - begin

    def _time(self) -> float:
        """Never goes back, even if a simulator restarts."""
        now, looked = self._now(), monotonic()
        if now == self._seen:
            self._stands += looked - self._looked
            if self._stands > _STANDING:
                self._more += looked - self._looked
        else:
            self._stands = 0.0
            self._more += max(0.0, self._seen - now)
        self._seen, self._looked = now, looked
        return now + self._more

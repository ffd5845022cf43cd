"""Time that always goes on, made of a clock that may not: that of a simulator, which others publish."""

from __future__ import annotations

import time
from collections.abc import Callable

STANDING = 1.0
"""Real seconds for which a clock may stand still, as that of a simulator does between its ticks."""
_SLOWEST = 100.0  # a clock that goes on more slowly than a hundredth of real time stands still
_LEAP, _FASTEST = 10.0, 1000.0  # seconds that a clock may be ahead of a look, and how often as fast it may be


class SteadyTime:
    """Seconds that follow the clock `read` and never go back; from any thread.

    A clock may stand still, run backwards or leap, and two programs may publish it in turn. What isn't a step forward
    is not counted. After STANDING seconds of that, time goes on with the computer's clock until the other one steps
    forward again from where it then is, as that of a simulator that was restarted does. So what waits for a time always
    gets there. `said` is called once with each thing that a clock should not do.
    """

    def __init__(self, read: Callable[[], float], said: Callable[[str], object] = str) -> None:
        self._read, self._said = read, said
        self._warned: set[str] = set()
        self.has_failed = False
        """Whether the clock has done what a clock should not do."""
        now = read()
        # what the clock said and when, how long it has stood still, and the time that was made of it; replaced as one
        self._seen: tuple[float, float, float, float] = now, time.monotonic(), 0.0, now

    def now(self) -> float:
        """Seconds."""
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

"""How often something may be sent."""

from __future__ import annotations

_EARLY = 0.5  # of a period
_SHORTER = 0.95  # of a period: what comes once in each catches up after something came between


class Allowance:
    """Once in `period` seconds on average, within five in a hundred. What comes in step with that, but not evenly, need
    not wait: who slept out each period would fall behind by a little each time, up to a whole period.
    """

    def __init__(self, period: float) -> None:
        self._period = period * _SHORTER
        self._due = 0.0

    def wait(self, now: float) -> float:
        """Seconds until it may be sent."""
        return max(0.0, self._due - self._period * _EARLY - now)

    def use(self, now: float) -> None:
        """It is sent."""
        self._due = max(self._due, now) + self._period

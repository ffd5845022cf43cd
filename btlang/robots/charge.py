"""Whether the percentage that a battery reports can be true."""

from __future__ import annotations

_JUMP, _FASTEST = 10.0, 1.0  # percent that a gauge may jump, and a second that a battery gains or loses at most
_HOLDS = 0.9  # seconds that another charge has to be reported for: drivers may repeat a sample
_COUNTS = 3.0  # seconds


class ChargeCheck:
    """For the percentages of one battery, in the order in which they come. A jump that no battery makes has to be
    reported again.
    """

    def __init__(self) -> None:
        self._believed: tuple[float, float] | None = None  # percent, and when
        self._doubted: tuple[float, float] | None = None

    def believes(self, percent: float, now: float) -> bool:
        """Whether a percentage counts, at a second of any clock."""
        if self._believed is None or self._follows(self._believed, percent, now):
            self._believed, self._doubted = (percent, now), None
        elif self._doubted is None or not self._follows(self._doubted, percent, now):
            self._doubted = percent, now
        elif now - self._doubted[1] >= _HOLDS:
            self._believed, self._doubted = (percent, now), None
        return self._doubted is None

    def is_recent(self, now: float) -> bool:
        """Whether a percentage was believed a short time ago, so that it still counts while another one is doubted."""
        return self._believed is not None and now - self._believed[1] <= _COUNTS

    def fault(self, percent: float, now: float) -> str:
        """Why a percentage isn't believed, to be read after the name of the sensor; "" if it is."""
        before = self._believed
        return "" if self.believes(percent, now) or before is None else f"jumps from {before[0]:.0f}% to {percent:.0f}%"

    @staticmethod
    def _follows(before: tuple[float, float], percent: float, now: float) -> bool:
        return abs(percent - before[0]) <= _JUMP + _FASTEST * (now - before[1])

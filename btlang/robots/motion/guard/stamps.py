"""Whether the time stamps of a sensor can be true. The clocks of two computers may differ by any time."""

from __future__ import annotations

_LATE = 0.7  # seconds more than usual that a message may be under way
_EARLY = 0.3  # seconds before its measurement that a message seems to arrive: its clock has been set
_BACK = 1e-6
_LEARNING = 2.0  # seconds from the first message in which one may show that the ones before were held up
_AGAIN = 3.0  # seconds in which stamps go on steadily after a jump, until they are believed again


class StampCheck:
    """For the messages of one sensor, in the order in which they arrive. Seconds; a stamp of 0 is none.

    The offset between both clocks is learnt from the message that was under way for the shortest time.
    """

    def __init__(self) -> None:
        self._before: float | None = None
        self._offset: float | None = None
        self._steady_since: float | None = None
        self._first: float | None = None
        self._last = 0.0

    def fault(self, stamp: float, arrival: float, lags: bool = True) -> str:
        """Why a stamp can't be true, to be read after the name of the sensor; "" if it can.

        Without `lags` it isn't judged how long messages are under way: their clock may be faster than real time.
        """
        if stamp == 0.0:
            return ""
        before, self._before = self._before, stamp
        self._last, last = arrival, self._last
        if before is not None and stamp == before:
            return "repeats its time stamp"
        if before is not None and stamp < before - _BACK:
            return self._jumped(f"has time stamps that go back by {before - stamp:.2f} s", arrival, last)
        if not lags:
            return ""
        under_way = arrival - stamp
        if self._offset is None or self._first is None:
            self._offset, self._first = under_way, arrival
        late = under_way - self._offset
        if late > _LATE:
            return self._jumped(f"is {late:.1f} s old", arrival, last, under_way)
        held_up = arrival - self._first < _LEARNING and late > -_LEARNING
        if late < -_EARLY and not held_up:
            return self._jumped(f"has time stamps that are {-late:.1f} s in the future", arrival, last, under_way)
        self._offset, self._steady_since = min(self._offset, under_way), None
        return ""

    def _jumped(self, reason: str, arrival: float, last: float, under_way: float | None = None) -> str:
        """A clock that was set is believed again once its stamps have been steady for a while."""
        if self._steady_since is None or under_way is None or arrival - last > _LATE:
            self._steady_since = arrival
        if under_way is not None and arrival - self._steady_since > _AGAIN:
            self._offset, self._steady_since = under_way, None
            return ""
        return reason

"""Delays after wrong passwords, by account, and by address."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable
from math import inf

FREE = 5
"""Wrong passwords that cost nothing: people mistype."""
_FIRST, _LONGEST = 1.0, 60.0  # seconds
_FORGOTTEN = 900.0  # seconds after which a wrong password counts no more
_MOST_KNOWN = 10_000


class Throttle:
    """Counts wrong passwords in a row of one kind of thing. Each one after the first few doubles the time to wait.

    It forgets who was wrong least recently when too many are known. `clock` gives seconds.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._wrong: OrderedDict[str, tuple[int, float]] = OrderedDict()  # how many, and when the last one was

    def wait(self, key: str) -> float:
        """Seconds until somebody may try again, 0 if at once."""
        count, last = self._known(key)
        if count < FREE:
            return 0.0
        pause = min(_FIRST * 2.0 ** (count - FREE), _LONGEST)
        return max(0.0, last + pause - self._clock())

    def wrong(self, key: str) -> None:
        """Somebody was wrong."""
        count, _ = self._known(key)
        self._wrong[key] = (count + 1, self._clock())
        self._wrong.move_to_end(key)
        while len(self._wrong) > _MOST_KNOWN:
            self._wrong.popitem(last=False)

    def right(self, key: str) -> int:
        """Somebody was right: counting starts again. Returns how many were wrong."""
        count, _ = self._known(key)
        self._wrong.pop(key, None)
        return count

    def forgive(self, key: str, count: int) -> None:
        """So many wrong ones count no more."""
        if key in self._wrong:
            known, last = self._wrong[key]
            self._wrong[key] = (max(0, known - count), last)

    def _known(self, key: str) -> tuple[int, float]:
        count, last = self._wrong.get(key, (0, -inf))
        return (count, last) if self._clock() - last < _FORGOTTEN else (0, last)

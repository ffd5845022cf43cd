"""An event that may be set where a signal interrupts, unlike those of threading."""

from __future__ import annotations

from _thread import allocate_lock
from contextlib import suppress


class Waker:
    """What one thread sleeps at until another one, or a signal handler, wakes it.

    An Event of threading has a lock that an exception of a signal handler may leave taken for ever.
    """

    def __init__(self) -> None:
        self._asleep = allocate_lock()  # held but for a moment
        self._asleep.acquire()

    def wake(self) -> None:
        """End the sleep, or the next one."""
        with suppress(RuntimeError):  # it is released already
            self._asleep.release()

    def sleep(self, seconds: float | None = None) -> None:
        """Wait so many seconds (None: without an end), or until somebody wakes."""
        self._asleep.acquire(timeout=-1 if seconds is None else max(0.0, seconds))

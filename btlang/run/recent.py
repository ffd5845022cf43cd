"""The latest events of a run, for who asks late."""

from __future__ import annotations

from collections import deque
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import suppress
from threading import Condition, RLock

from btlang.run.bus import INLINE
from btlang.run.events import PeriodPassed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Event

MOST_EVENTS = 10_000
"""The number of events that are kept, where each change of a status counts: what is kept is garbage to look through
while robots move.
"""


class RecentEvents:
    """A sink that keeps the latest events for late readers, in any thread."""

    policy = INLINE

    def __init__(self) -> None:
        self._events: deque[Event] = deque()
        self._kept = self._count = 0
        self._over = False
        self._lock = RLock()  # taken by itself: a Condition may keep it where a signal interrupts
        self._changed = Condition(self._lock)
        self._waiting: list[Callable[[], None]] = []  # what wakes the readers in loops of asyncio

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed):
            return
        with self._lock:
            self._events.append(event)
            self._kept += event.count
            self._count += 1
            while self._kept > MOST_EVENTS and len(self._events) > 1:
                self._kept -= self._events.popleft().count
            self._notify()

    def open(self) -> None:
        """Note that the run goes on, or starts over."""
        self._over = False

    def close(self) -> None:
        """Note that the run is over."""
        with self._lock:
            self._over = True
            self._notify()

    def events(self) -> Iterator[Event]:
        """Yield the latest ones, then new ones until `close`."""
        given = 0
        while True:
            with self._lock:
                while self._count == given and not self._over:
                    self._changed.wait()
                batch, given = self._after(given)
            if not batch:
                return
            yield from batch

    async def events_async(self) -> AsyncIterator[Event]:
        """Yield the events as `events` does, for a task of asyncio, whose loop it doesn't block meanwhile."""
        from asyncio import Event as Signal
        from asyncio import get_running_loop

        loop, arrived, given = get_running_loop(), Signal(), 0

        def wake() -> None:
            with suppress(RuntimeError):  # the loop is closed
                loop.call_soon_threadsafe(arrived.set)

        self._waiting.append(wake)
        try:
            while True:
                arrived.clear()
                with self._lock:
                    batch, given = self._after(given)
                    over = self._over
                for event in batch:
                    yield event
                if over:
                    return
                await arrived.wait()
        finally:
            self._waiting.remove(wake)

    def _after(self, given: int) -> tuple[list[Event], int]:
        """Return the kept ones behind the first `given`, and how many there have been now."""
        new = min(self._count - given, len(self._events))
        return list(self._events)[len(self._events) - new :], self._count

    def _notify(self) -> None:
        self._changed.notify_all()
        for wake in tuple(self._waiting):
            wake()

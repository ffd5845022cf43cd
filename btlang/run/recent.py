"""The latest events of a run, for who asks late."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from threading import Condition

from btlang.run.bus import INLINE
from btlang.run.events import PeriodPassed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Event

MOST_EVENTS = 10_000
"""So many are kept, where each change of a status counts: what is kept is garbage to look through while robots move."""


class RecentEvents:
    """A sink that keeps the latest events for late readers, in any thread."""

    policy = INLINE

    def __init__(self) -> None:
        self._events: deque[Event] = deque()
        self._kept = self._count = 0
        self._over = False
        self._changed = Condition()

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed):
            return
        with self._changed:
            self._events.append(event)
            self._kept += event.count
            self._count += 1
            while self._kept > MOST_EVENTS and len(self._events) > 1:
                self._kept -= self._events.popleft().count
            self._changed.notify_all()

    def close(self) -> None:
        """The run is over."""
        with self._changed:
            self._over = True
            self._changed.notify_all()

    def events(self) -> Iterator[Event]:
        """The latest ones, then new ones until `close`."""
        given = 0
        while True:
            with self._changed:
                while self._count == given and not self._over:
                    self._changed.wait()
                new = min(self._count - given, len(self._events))
                batch = list(self._events)[len(self._events) - new :]
                given = self._count
            if not batch:
                return
            yield from batch

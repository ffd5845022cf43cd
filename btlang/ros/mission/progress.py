"""What a mission is doing now, for other programs."""

from __future__ import annotations

import time
from collections.abc import Callable

from btlang.run.bus import INLINE
from btlang.run.events import Ended, PeriodPassed, StatusesChanged
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

    from btlang.run.events import Event
    from btlang.run.snapshot import Snapshot

_PAUSE = 0.1  # seconds of real time between two snapshots of all nodes


class News(Record):
    """Statuses of nodes by path at a time of the mission, and the words of the commands that run.

    `is_last` where the run is over.
    """

    time: float
    running: str
    statuses: Mapping[str, int]
    is_last: bool = False


class Progress:
    """A sink that hands on, once a tick at most, the nodes with a new status, and now and then and at the end all.

    `snapshot` is that of the run. The other functions are called in the thread of the run, and at its end.
    """

    policy = INLINE

    def __init__(
        self,
        snapshot: Callable[[], Snapshot],
        changed: Callable[[News], object],
        reached: Callable[[News], object],
    ) -> None:
        self._snapshot, self._changed, self._reached = snapshot, changed, reached
        self._new: dict[str, int] = {}
        self._pending = False
        self._reached_at = -_PAUSE

    def __call__(self, event: Event) -> None:
        if isinstance(event, StatusesChanged):
            for change in event:
                self._new[change.path] = change.status
        elif isinstance(event, PeriodPassed):
            self._report(time.monotonic() - self._reached_at >= _PAUSE)
        elif isinstance(event, Ended):
            self._report(True, is_last=True)

    def _report(self, all_too: bool, *, is_last: bool = False) -> None:
        if not (is_last or self._new or (self._pending and all_too)):
            return
        now = self._snapshot()
        running = "; ".join(now.running)
        if self._new:
            self._changed(News(now.t, running, self._new))
            self._new, self._pending = {}, True
        if all_too:
            self._pending, self._reached_at = False, time.monotonic()
            self._reached(News(now.t, running, now.statuses, is_last))

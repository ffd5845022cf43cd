"""What a mission is doing now, from its stream of events."""

from __future__ import annotations

import time
from collections.abc import Callable

from btlang.engine.status import RUNNING
from btlang.record import Record
from btlang.run.events import PeriodPassed, RobotEvent, StatusChanged, StatusesChanged
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

    from btlang.run.events import Event

_PAUSE = 0.1  # seconds of real time between two snapshots of all nodes


class News(Record):
    """Statuses of nodes by path at a time of the mission, and the words of the commands that run."""

    time: float
    running: str
    statuses: Mapping[str, int]


class Progress:
    """A sink that hands on, once a tick at most, the nodes with a new status, and now and then all of them.

    `label` gives the words for a node. Both functions are called in the thread of the run, and at its end.
    """

    def __init__(
        self,
        label: Callable[[Node], str],
        changed: Callable[[News], object],
        snapshot: Callable[[News], object],
    ) -> None:
        self._label, self._tell_changed, self._tell_all = label, changed, snapshot
        self._new: dict[str, int] = {}
        self._all: dict[str, int] = {}
        self._untold = False
        self._running: dict[int, str] = {}
        self._told = -_PAUSE

    def __call__(self, event: Event) -> None:
        if isinstance(event, StatusesChanged):
            for change in event:
                self._change(change)
        elif isinstance(event, PeriodPassed):
            self._tell(event.t, time.monotonic() - self._told >= _PAUSE)
        elif isinstance(event, RobotEvent) and event.kind == "end":
            self._tell(event.t, True)

    def _change(self, change: StatusChanged) -> None:
        self._new[change.path] = change.status
        if change.status != RUNNING:
            self._running.pop(change.index, None)
        elif not change.node.children and change.node.id != SUBTREE:
            self._running[change.index] = self._label(change.node)

    def _tell(self, now: float, all_too: bool) -> None:
        running = "; ".join(self._running.values())
        if self._new:
            self._tell_changed(News(now, running, self._new))
            self._all.update(self._new)
            self._new, self._untold = {}, True
        if self._untold and all_too:
            self._untold, self._told = False, time.monotonic()
            self._tell_all(News(now, running, self._all))

"""The progress of a run, and its tree as a topic. Imports no interfaces."""

from __future__ import annotations

import json
import time
from collections.abc import Callable

from btlang.api import Mission
from btlang.engine.status import NAMES
from btlang.run.bus import INLINE
from btlang.run.events import Ended, PeriodPassed, StatusesChanged
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

    from btlang.run.events import Event
    from btlang.run.snapshot import Snapshot
    from btlang.session import Run

_PAUSE = 0.1  # seconds of real time between two snapshots of all nodes
_TREE_PAUSE = 1.0  # seconds of real time between two snapshots while statuses change


class RunUpdate(Record):
    """Statuses of nodes by path at a time of the mission, and the words of the running commands.

    `is_last` is true when the run is over.
    """

    time: float
    running: str
    statuses: Mapping[str, int]
    is_last: bool = False


class MissionProgress:
    """A sink that passes on the nodes with a new status, at most once a tick, and now and then and at the end all
    nodes.

    `snapshot` is that of the run. The other functions are called in the thread of the run, and at its end.
    """

    policy = INLINE

    def __init__(
        self,
        snapshot: Callable[[], Snapshot],
        changed: Callable[[RunUpdate], object],
        reached: Callable[[RunUpdate], object],
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
            self._changed(RunUpdate(now.t, running, self._new))
            self._new, self._pending = {}, True
        if all_too:
            self._pending, self._reached_at = False, time.monotonic()
            self._reached(RunUpdate(now.t, running, now.statuses, is_last))


class TreeTopic:
    """The tree of a run as a snapshot and changes; `snapshot` and `changes` publish a text.

    Both have the id of the run and a `sequence`, which counts the changes: a snapshot includes those up to its own. So
    a late listener applies only later ones, and notices if one was lost.
    """

    def __init__(
        self, mission: Mission, run: Run, snapshot: Callable[[str], object], changes: Callable[[str], object]
    ) -> None:
        self._snapshot, self._changes = snapshot, changes
        nodes = [
            {"path": path, "id": node.id, "words": mission.label(node), "ports": dict(node.ports)}
            for path, node in run.nodes.nodes
        ]
        self._head = {"run": run.id, "outline": str(mission), "nodes": nodes}
        self._sequence = 0
        self._published_at = time.monotonic()
        self._snapshot(json.dumps({**self._head, "sequence": 0, "time": 0.0, "statuses": {}}))

    def publish_changes(self, news: RunUpdate) -> None:
        """Publish the nodes with a new status."""
        self._sequence += 1
        changes = {
            "run": self._head["run"],
            "sequence": self._sequence,
            "time": news.time,
            "changes": _status_names(news),
        }
        self._changes(json.dumps(changes))

    def publish_snapshot(self, news: RunUpdate, *, is_last: bool = False) -> None:
        """Publish all nodes that were reached."""
        now = time.monotonic()
        if is_last or now >= self._published_at + _TREE_PAUSE:
            self._published_at = now
            state = {"sequence": self._sequence, "time": news.time, "statuses": _status_names(news)}
            self._snapshot(json.dumps({**self._head, **state}))


def _status_names(news: RunUpdate) -> dict[str, str]:
    return {path: NAMES[status] for path, status in news.statuses.items()}

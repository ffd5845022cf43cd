"""The tree of a run and how it goes, as JSON for programs that may join late: a snapshot and changes."""

from __future__ import annotations

import json
import time
from collections.abc import Callable

from btlang.api import Mission
from btlang.engine.status import NAMES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.ros.mission.progress import News
    from btlang.session import Run

_PAUSE = 1.0  # seconds of real time between two snapshots while statuses change


class TreeTopic:
    """`snapshot` and `changes` publish a text. Both have the id of the run and a `sequence`, which counts the changes:
    a snapshot holds those up to its own, so whoever joins applies only later ones, and knows when one was lost.
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

    def changed(self, news: News) -> None:
        """The nodes with a new status."""
        self._sequence += 1
        changes = {"run": self._head["run"], "sequence": self._sequence, "time": news.time, "changes": _named(news)}
        self._changes(json.dumps(changes))

    def reached(self, news: News, *, is_last: bool = False) -> None:
        """All nodes that were reached."""
        now = time.monotonic()
        if is_last or now >= self._published_at + _PAUSE:
            self._published_at = now
            state = {"sequence": self._sequence, "time": news.time, "statuses": _named(news)}
            self._snapshot(json.dumps({**self._head, **state}))


def _named(news: News) -> dict[str, str]:
    return {path: NAMES[status] for path, status in news.statuses.items()}

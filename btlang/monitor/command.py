"""What `--groot` does for `btc run` and `btc replay`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

from btlang.api import Mission
from btlang.monitor.groot import GrootServer
from btlang.monitor.groot_tree import GrootTree, models_of
from btlang.run.controls import Controls
from btlang.run.events import Event, Sampled
from btlang.run.snapshot import Follower
from btlang.session import Run

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.snapshot import State, WatchedNodes


class GrootMonitor:
    """Shows a run to Groot2; see btlang.run.command.run_mission."""

    def __init__(self, server: GrootServer) -> None:
        self.server = server
        self.hooks = server.breakpoints

    def watch_run(self, run: Run, mission: Mission) -> None:
        """From now on the server answers about this run."""
        nodes = run.nodes
        self.server.watch(run.follower, partial(groot_tree, nodes, mission), nodes.values)
        run.bus.add(self.server)


@contextmanager
def groot_monitor(port: int, controls: Controls) -> Iterator[GrootMonitor]:
    """As long as the run lasts. Raises MissionError (BT085, BT086)."""
    server = GrootServer(port, controls)
    try:
        yield GrootMonitor(server)
    finally:
        server.close()


class ReplayMonitor:
    """A sink that shows a recorded run to Groot2 while it is played."""

    def __init__(self, server: GrootServer, nodes: WatchedNodes, mission: Mission) -> None:
        self._server = server
        self._values: dict[str, Any] = {}
        self._follower = Follower(nodes)
        server.watch(self._follower, partial(groot_tree, nodes, mission), self._values_of)

    def __call__(self, event: Event) -> None:
        """An event of the recording."""
        if isinstance(event, Sampled):
            self._values = {**self._values, **event.values}
            return
        self._follower(event)
        self._server(event)

    def jump(self, state: State) -> None:
        """The replay has gone on elsewhere."""
        self._follower.jump(state)

    def _values_of(self, index: int) -> dict[str, Any]:
        """Only those of the whole mission are recorded."""
        return self._values if index == 0 else {}


def groot_tree(nodes: WatchedNodes, mission: Mission) -> GrootTree:
    """The tree of a run of a mission."""
    return GrootTree(nodes, nodes.parent, mission.label, models_of(lambda: str(mission.to("xml"))))

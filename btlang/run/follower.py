"""Follows the statuses of a run, for any thread, and what of them is new for somebody."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from threading import Lock

from btlang.engine.changes import differences
from btlang.engine.status import IDLE, RUNNING
from btlang.run.bus import INLINE
from btlang.run.snapshot import HALTED, SUSPENDED, RunState, Shape, Snapshot
from btlang.run.statuses import Status
from btlang.support.gc_pause import gc_paused

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Event
    from btlang.run.snapshot import WatchedNodes
    from btlang.tree.node import Node

_RUNNING = re.compile(bytes([RUNNING]))
_NOT_0 = re.compile(rb"[^\0]")


class RunFollower:
    """A sink that follows a run, and gives snapshots of it to any thread."""

    policy = INLINE

    def __init__(self, engine: WatchedNodes) -> None:
        self._engine = engine
        self._lock = Lock()
        self._state: RunState | None = None
        self._latest: Event | None = None
        self._nodes: Sequence[Node] = ()
        self._snapshots = Lock()  # for what the latest snapshot knew
        self._known: KnownNodes | None = None
        self._paths: dict[int, str] = {}
        self._reached: dict[str, Status] = {}

    def __call__(self, event: Event) -> None:
        with self._lock:
            if self._state is None:
                count = self._engine.size
                self._nodes = [self._engine.node(index) for index in range(count)]
                self._state = RunState(Shape([self._engine.parent(index) for index in range(count)]), self._nodes, True)
            self._state.take(event)
            self._latest = event

    def jump(self, state: RunState) -> None:
        """Go on from another state of the same tree."""
        with self._lock:
            self._state = state

    def snapshot(self, label: Callable[[Node], str]) -> Snapshot:
        """Return the state now; `label` gives the words of a command."""
        with self._lock:
            state, latest = self._state, self._latest
            if state is None or latest is None:
                return Snapshot("", -1, 0.0, Status.IDLE, {}, (), "", None)
            codes = bytes(state.statuses)
            number = latest.number + latest.count - 1
            run, t, said, robot = latest.run, latest.t, state.doing.says, state.robot
        leaves = [found.start() for found in _RUNNING.finditer(codes) if state.is_leaf(found.start())]
        running = tuple(label(self._nodes[index]) for index in leaves)
        return Snapshot(run, number, t, _status(codes[0]), self._by_path(codes), running, said, robot)

    def _by_path(self, codes: bytes) -> dict[str, Status]:
        """Return the statuses of the nodes that were reached. It takes as long as there are changes since the last."""
        with self._snapshots, gc_paused:
            if self._known is None:
                self._known = KnownNodes(len(codes))
            for index, code in self._known.new_statuses(codes):
                path = self._paths.get(index)
                if path is None:
                    path = self._paths[index] = self._engine.path(index)
                if code == IDLE:
                    self._reached.pop(path, None)
                else:
                    self._reached[path] = Status(code)
            return self._reached.copy()

    def codes(self) -> bytes:
        """Return the status of each node in preorder, also HALTED and SUSPENDED; nothing before the first event."""
        with self._lock:
            return bytes(self._state.statuses) if self._state is not None else b""

    def statuses(self, label: Callable[[Node], str]) -> dict[str, Status]:
        """Return the status of each node by its words."""
        with self._lock:
            codes = list(self._state.statuses) if self._state is not None else []
        found: dict[str, Status] = {}
        for node, code in zip(self._nodes, codes, strict=True):
            words, status = label(node), _status(code)
            if status != Status.IDLE or words not in found:
                found[words] = status
        return found


def _status(code: int) -> Status:
    return Status(min(code, IDLE))  # HALTED and SUSPENDED are IDLE for everybody else


_SHOWN = bytes.maketrans(bytes([HALTED, SUSPENDED]), bytes([IDLE, IDLE]))


class KnownNodes:
    """The statuses and the words of `count` nodes, as somebody has got them so far. In the beginning all are IDLE."""

    def __init__(self, count: int) -> None:
        self._codes = bytes([IDLE]) * count
        self._valued: dict[int, Node] = {}

    def new_statuses(self, codes: bytes) -> list[tuple[int, int]]:
        """Return number and status of each node that has another status by now; HALTED and SUSPENDED are IDLE."""
        before, self._codes = self._codes, codes.translate(_SHOWN)
        changed = differences(before, self._codes)
        return [(found.start(), self._codes[found.start()]) for found in _NOT_0.finditer(changed)]

    def new_values(self, valued: Mapping[int, Node]) -> list[tuple[int, Node]]:
        """Return number and node, with the values of its keys, of each one whose keys have other values by now."""
        found = []
        for index, node in valued.items():
            known = self._valued.get(index)
            if known is not node:
                self._valued[index] = node
                if known is None or known.ports != node.ports:
                    found.append((index, node))
        return found

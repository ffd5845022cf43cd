"""What every node of the reference interpreter has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable
from typing import Any, Self

from btlang.engine.clock import Clock
from btlang.engine.status import IDLE, RUNNING
from btlang.tree.node import Node, Tree

from .reference_board import Board


class Mission:
    """What all nodes share. `scripts` gives the letters of each leaf id; each call takes the next."""

    def __init__(self, tree: Tree, scripts: dict[str, str], clock: Clock) -> None:
        self.subtrees = dict(tree.subtrees)
        self.scripts = scripts
        self.clock = clock
        self.log: list[str] = []
        self.calls: Counter[str] = Counter()
        self.emergency = False
        self.unknowns = 0  # how many nodes had no answer


class ReferenceNode(ABC):
    """The state of one node. `working`: its child returned RUNNING when it was last ticked."""

    def __init__(self, node: Node, mission: Mission, board: Board, parent: Self | None = None) -> None:
        self.node, self.mission, self.board, self.parent = node, mission, board, parent
        self.log, self.clock = mission.log, mission.clock
        below, nodes = board, node.children
        if node.id == "SubTree":
            below, nodes = board.of_subtree(node.ports), (mission.subtrees[node.port("ID")],)
        self.children = [type(self)(child, mission, below, self) for child in nodes]
        self.lasting = node.id[0] in "CG" and node.id[1:].isdigit()  # a leaf that starts and can be halted
        self.status = IDLE
        self.at = self.count = self.skipped = self.seen = 0
        self.completed: set[int] = set()
        self.goal: Any = None
        self.failures = self.successes = 0
        self.since: float | None = None
        self.kept = 0.0
        self.due: float | None = None
        self.late = self.started = self.stopped = self.catching = self.reacting = self.working = False
        self.left = False  # whether its parent is halting it
        self.armed, self.fired = True, False
        self.once = IDLE
        self.queue: list[str] = []
        self.path: list[list[float]] = []
        self.behaviour: Callable[[], int] = getattr(self, node.id, self.leaf)

    @abstractmethod
    def execute(self) -> int:
        """Its status after one more tick."""

    @abstractmethod
    def halt(self) -> None:
        """Stops what runs below it, and resets it."""

    @abstractmethod
    def leaf(self) -> int:
        """What a node does that is none of the built-in ones."""

    def suspend(self) -> None:
        if self.lasting and self.status == RUNNING and not self.stopped:
            self.log.append(f"{self.node.id}.halt")
            self.stopped = True
        if self.since is not None:
            self.kept += self.clock.now - self.since
            self.since = None
        if self.node.id == "Whenever":
            self.working = False
        for child in self.children:
            child.suspend()

    def passed(self) -> float:
        if self.since is None:
            self.since = self.clock.now
        return self.kept + self.clock.now - self.since

    def stop_watch(self) -> None:
        self.since, self.kept = None, 0.0

    def reset(self) -> None:
        if self.status == RUNNING:
            self.left = True
            self.halt()
            self.left = False
        self.status = IDLE

    def reset_children(self) -> None:
        for child in self.children:
            child.reset()

    def number(self, port: str) -> int:
        return int(self.node.port(port))

"""Leaves that work with the values of a mission, or do what a keyword entry says: each is an engine of one node."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

from py_trees.common import Status

from btlang.backends.py_trees.node import SKIPPED, Asking, Node
from btlang.engine.blackboard import Blackboard
from btlang.engine.compile import child_scope
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.text.time_of_day import local
from btlang.tree import node as btlang_node
from btlang.tree.catalogue import SUBTREE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_STATUSES = {RUNNING: Status.RUNNING, SUCCESS: Status.SUCCESS, FAILURE: Status.FAILURE}


class _Clock:
    """A clock as the engine asks for it. Whoever ticks the tree doesn't know when it is due.

    The time of day is that of the robot, else of this computer.
    """

    def __init__(self, now: Callable[[], float], robot: Any) -> None:
        self._now, self._robot = now, robot

    @property
    def now(self) -> float:
        return self._now()

    @property
    def time_of_day(self) -> float:
        return float(self._robot.time_of_day) if hasattr(self._robot, "time_of_day") else local(time.time())

    def wake_at(self, time: float) -> None:
        """Do nothing."""

    leaf_wake_at = wake_at


class EngineLeaf(Node):
    """A leaf of btlang's engine. `feedback_message` says why it failed."""

    def __init__(self, name: str, engine: Engine) -> None:
        super().__init__(name)
        self.engine = engine

    def halt(self, keep: bool) -> None:
        self.engine.suspend() if keep else self.engine.halt()

    def run(self) -> Asking:
        unknowns = self.engine.unknowns
        status = self.engine.tick()
        self.known = self.engine.unknowns == unknowns
        self.feedback_message = self.engine.failure.reason if self.engine.failure is not None else ""
        return _STATUSES.get(status, SKIPPED)
        yield self  # never; but it makes this a generator, as `run` is


def engine_leaf(
    name: str,
    id: str,
    ports: Mapping[str, str],
    values: Blackboard,
    now: Callable[[], float],
    bind: Callable[[str], LeafBinding | None] = lambda id: None,
    services: Mapping[str, Any] = {},
) -> EngineLeaf:
    """Make a leaf with the values of its subtree. Raises EngineError if it can't be bound so."""
    tree = btlang_node.Tree(btlang_node.Node(id, ports=tuple(ports.items())))
    clock: Any = _Clock(now, services.get("robot"))
    return EngineLeaf(name, Engine(tree, bind, clock=clock, services=services, blackboard=values))


def values_of(ports: Mapping[str, str], values: Blackboard) -> Blackboard:
    """Return the values that a subtree with these ports sees."""
    return child_scope(btlang_node.Node(SUBTREE, ports=tuple(ports.items())), values)

"""A tree that can be ticked."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping

from btlang.engine.blackboard import Blackboard
from btlang.engine.build import EngineError, Fault, Shared
from btlang.engine.clock import Clock
from btlang.engine.compile import compile_places, expand
from btlang.engine.leaf import LeafBinding
from btlang.engine.status import FAILURE, IDLE
from btlang.garbage import no_collection
from btlang.record import Record
from btlang.text.source import Span
from btlang.tree.node import Node, Tree

__all__ = ["Engine", "EngineError", "Failure"]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.timing import Stopwatch
    from btlang.engine.watch import Listener

_FRAMES_PER_LEVEL = 4  # a node, its watch, its pre-conditions, and the check of ports from the blackboard
_FRAMES_FOR_LEAVES = 1000


class Failure(Record):
    """Why a node failed: in words ("" where a condition was just not true), with the exception where one was raised.

    `span` is the sentence of the node, or of the nearest one around it that has one.
    """

    node: Node
    path: str
    reason: str
    exception: BaseException | None = None
    span: Span | None = None


class Engine:
    """A compiled tree. `bind` gives the Python side of a leaf id, `services` what leaves may ask for by name.

    `enums` are names of numbers that scripts and the cases of Switch nodes may use. A `stopwatch` times the leaves.

    Raises EngineError where the tree cannot be compiled. `listener` is called with the index of a node in preorder and
    its new status at every change, children before parents; see watch.py for what counts as one.
    """

    def __init__(
        self,
        tree: Tree,
        bind: Callable[[str], LeafBinding | None],
        *,
        clock: Clock,
        services: Mapping[str, Any] = {},
        blackboard: Blackboard | None = None,
        listener: Listener | None = None,
        enums: Mapping[str, float] = {},
        stopwatch: Stopwatch | None = None,
    ) -> None:
        self.blackboard = Blackboard() if blackboard is None else blackboard
        self.stopwatch = stopwatch
        self.on_wake: Callable[[], object] | None = None
        """What the service `wake` calls, in the thread of whoever asks for it: "tick again now"."""
        self._shared = Shared(bind, clock, {"wake": self._wake, **services}, enums, stopwatch)
        with no_collection:
            self._places = expand(tree, self.blackboard)
            self._tick, self._halt = compile_places(self._places, self._shared, listener)
        depth = max([place.depth for place in self._places])
        self._frames = depth * _FRAMES_PER_LEVEL + _FRAMES_FOR_LEAVES
        self._busy = False
        self.status = IDLE
        self.failure: Failure | None = None

    def tick(self) -> int:
        """Ticks the tree once; returns its status. `failure` then tells why it failed, None for any other status.

        An exception that is no error of a leaf (KeyboardInterrupt, SystemExit) halts the tree and comes through.
        """
        self._enter()
        try:
            self.status = status = self._tick()
            self.failure = self._root_failure() if status == FAILURE else None
            return status
        except BaseException:
            self._halt_all(False)
            raise
        finally:
            self._busy = False

    def halt(self, emergency: bool = False) -> None:
        """Halts every running leaf, children before parents, and resets all nodes; the next tick starts anew.

        Only a SequenceWithMemory keeps its place, as in BehaviorTree.CPP. `emergency` tells the nodes that it is that
        of an emergency stop, in which they start nothing.
        """
        self._enter()
        self._shared.emergency = emergency
        try:
            self._halt_all(False)
        finally:
            self._shared.emergency = False
            self._busy = False

    def suspend(self) -> None:
        """Halts every running leaf but keeps positions, counts and timers; the next tick starts those leaves anew."""
        self._enter()
        try:
            self._halt_all(True)
        finally:
            self._busy = False

    def take_halt_failures(self) -> list[Failure]:
        """What leaves raised while they were halted since it was last asked, oldest first.

        What a background leaf raises that ends after its halt is told once it has ended.
        """
        faults = self._shared.halt_faults
        if self._shared.background is not None:
            faults += self._shared.background.take_faults()
        if not faults:
            return []
        failures = [self._failure(fault) for fault in faults]
        faults.clear()
        return failures

    def close(self, patience: float = 0.0) -> list[Failure]:
        """Ends what works for background leaves, after a halt; returns those that were halted and have not ended.

        It waits for them at most `patience` seconds of real time. The engine can be ticked again.
        """
        background = self._shared.background
        if background is None:
            return []
        return [self._failure(Fault(index, "it did not end")) for index in background.close(patience)]

    @property
    def nodes(self) -> list[tuple[str, Node]]:
        """Path and node of all nodes in preorder, after expansion of subtrees; made at each call."""
        paths: list[str] = []
        for place in self._places:
            above = paths[place.parent] if place.parent > 0 else ""
            paths.append(f"{above}/{place.position}" if place.parent >= 0 else "/")
        return [(path, place.node) for path, place in zip(paths, self._places, strict=True)]

    def node(self, index: int) -> Node:
        """The node with an index in preorder."""
        return self._places[index].node

    def path(self, index: int) -> str:
        """Where a node is: `/` is the root, `/0/1` the second child of its first child; a SubTree's tree is child 0."""
        steps: list[str] = []
        while (place := self._places[index]).parent >= 0:
            steps.append(str(place.position))
            index = place.parent
        return "/" + "/".join(reversed(steps))

    def reason(self, index: int) -> str:
        """Why a node failed, "" where that is not known or another node has failed since."""
        fault = self._shared.fault
        return fault.reason if fault is not None and fault.index == index else ""

    def _wake(self) -> None:
        if self.on_wake is not None:
            self.on_wake()

    def _enter(self) -> None:
        if self._busy:
            raise RuntimeError("the tree is being ticked: neither a leaf nor another thread may tick or halt it now")
        if sys.getrecursionlimit() < self._frames:
            sys.setrecursionlimit(self._frames)
        self._busy = True

    def _halt_all(self, keep: bool) -> None:
        """Also when a leaf is interrupted while it halts: it counts as halted then, and another attempt goes on."""
        interrupted: BaseException | None = None
        self._shared.interrupts.clear()
        for _ in self._places:
            try:
                self._halt(keep)
                break
            except BaseException as exception:
                interrupted = interrupted or exception
        if not keep:
            self.status = IDLE
        if interrupted is not None:
            raise interrupted

    def _root_failure(self) -> Failure:
        return self._failure(self._shared.fault or Fault(0))

    def _failure(self, fault: Fault) -> Failure:
        index = fault.index
        while index >= 0 and self._places[index].node.span is None:
            index = self._places[index].parent
        span = self._places[index].node.span if index >= 0 else None
        return Failure(self.node(fault.index), self.path(fault.index), fault.reason, fault.exception, span)

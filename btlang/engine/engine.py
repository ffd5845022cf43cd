"""A tree that can be ticked."""

from __future__ import annotations

import sys
from _thread import allocate_lock  # `threading` takes longer to import
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

    from btlang.engine.watch import Listener

# A node, its watch, its pre-conditions, and the check of ports from the blackboard; twice, because what starts at the
# end of one branch may halt another one.
_FRAMES_PER_LEVEL = 8
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

    `enums` are names of numbers that scripts and the cases of Switch nodes may use.

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
    ) -> None:
        self.blackboard = Blackboard() if blackboard is None else blackboard
        self._shared = Shared(bind, clock, services, enums)
        with no_collection:
            self._places = expand(tree, self.blackboard)
            self._tick, self._halt = compile_places(self._places, self._shared, listener)
        depth = max([place.depth for place in self._places])
        self._frames = depth * _FRAMES_PER_LEVEL + _FRAMES_FOR_LEAVES
        self._alone = allocate_lock()
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
            self._halt_all(False, cut_short=True)
            raise
        finally:
            self._alone.release()

    def halt(self, emergency: bool = False) -> None:
        """Halts every running leaf, children before parents, and resets all nodes; the next tick starts anew.

        Only a SequenceWithMemory keeps its place, as in BehaviorTree.CPP. What `catch_on_halt` of a TryCatch starts
        to clean up does not run in an emergency.
        """
        self._enter()
        self._shared.emergency = emergency
        try:
            self._halt_all(False)
        finally:
            self._shared.emergency = False
            self._alone.release()

    def suspend(self) -> None:
        """Halts every running leaf but keeps positions, counts and timers; the next tick starts those leaves anew."""
        self._enter()
        try:
            self._halt_all(True)
        finally:
            self._alone.release()

    def take_halt_failures(self) -> list[Failure]:
        """What leaves raised while they were halted since it was last asked, oldest first."""
        faults = self._shared.halt_faults
        if not faults:
            return []
        failures = [self._failure(fault) for fault in faults]
        faults.clear()
        return failures

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

    def _enter(self) -> None:
        if not self._alone.acquire(False):
            raise RuntimeError("the tree is being ticked: neither a leaf nor another thread may tick or halt it now")
        if sys.getrecursionlimit() < self._frames:
            sys.setrecursionlimit(self._frames)

    def _halt_all(self, keep: bool, cut_short: bool = False) -> None:
        """Also when a leaf is interrupted while it halts: it counts as halted then, and another attempt goes on.

        Where a tick or a halt was cut short, nodes do not know which of their children run. So all is stopped before a
        TryCatch starts to clean up.
        """
        interrupted: BaseException | None = None
        for _ in range(len(self._places) + 1):  # each leaf interrupts it once at most, and so does each TryCatch
            self._shared.interrupts.clear()
            try:
                if cut_short:
                    self._halt(True)
                self._halt(keep)
                break
            except BaseException as exception:
                interrupted = interrupted or exception
                cut_short = True
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

"""A tree that can be ticked."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping

from btlang.engine.blackboard import Blackboard
from btlang.engine.build import EngineError, Fault, Shared, blackboard_key
from btlang.engine.clock import Clock
from btlang.engine.compile import compile_places, expand
from btlang.engine.leaf import REFUSED, LeafBinding, told
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

_FRAMES_PER_LEVEL = 4  # a node, its watch, its pre-conditions, and the check of ports from the blackboard
_FRAMES_FOR_LEAVES = 1000


class Failure(Record):
    """Why a node failed: in words, with the exception where one was raised.

    `span` is the sentence of the node, or of the nearest one around it that has one. `around` are the nodes around it
    that failed with it and add something, innermost first: that all attempts failed, say.
    """

    index: int
    node: Node
    path: str
    reason: str
    exception: BaseException | None = None
    span: Span | None = None
    around: tuple[Failure, ...] = ()


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
        self._busy = False
        self.status = IDLE
        self._fault: Fault | None = None

    def tick(self) -> int:
        """Ticks the tree once; returns its status. `failure` then tells why it failed, None for any other status.

        An exception that is no error of a leaf (KeyboardInterrupt, SystemExit) halts the tree and comes through.
        """
        self._enter()
        try:
            self.status = status = self._tick()
            self._fault = self._shared.fault if status == FAILURE else None
            return status
        except BaseException:
            self._halt_all(False)
            raise
        finally:
            self._busy = False

    @property
    def failure(self) -> Failure | None:
        """Why the latest tick failed: the leaf, or the decorator, that made the root fail. None where it did not."""
        return None if self._fault is None else self._failure(self._fault)

    def halt(self) -> None:
        """Halts every running leaf, children before parents, and resets all nodes; the next tick starts anew.

        Only a SequenceWithMemory keeps its place, as in BehaviorTree.CPP.
        """
        self._enter()
        try:
            self._halt_all(False)
        finally:
            self._busy = False

    def suspend(self) -> None:
        """Halts every running leaf but keeps positions, counts and timers; the next tick starts those leaves anew."""
        self._enter()
        try:
            self._halt_all(True)
        finally:
            self._busy = False

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

    def filled(self, index: int) -> Node:
        """As `node`, with the arguments of the subtrees around it in place of their `{names}`."""
        node, scope = self._places[index].node, self._places[index].scope
        keys = [(port, text, blackboard_key(port, text)) for port, text in node.ports]
        ports = tuple((port, text if key is None else scope.argument(key) or text) for port, text, key in keys)
        return node if ports == node.ports else node.replace(ports=ports)

    def path(self, index: int) -> str:
        """Where a node is: `/` is the root, `/0/1` the second child of its first child; a SubTree's tree is child 0."""
        steps: list[str] = []
        while (place := self._places[index]).parent >= 0:
            steps.append(str(place.position))
            index = place.parent
        return "/" + "/".join(reversed(steps))

    def parent(self, index: int) -> int:
        """The node above a node, -1 for the root."""
        return self._places[index].parent

    def span(self, index: int) -> Span | None:
        """The sentence of a node, or of the nearest one around it that has one."""
        while index >= 0 and self._places[index].node.span is None:
            index = self._places[index].parent
        return self._places[index].node.span if index >= 0 else None

    def reason(self, index: int) -> str:
        """Why a node failed in this tick, "" where only a node below it can say that."""
        fault = self._shared.fault
        while fault is not None and fault.index < index:  # causes are below
            fault = fault.cause
        return self._text(fault) if fault is not None and fault.index == index else ""

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

    def _text(self, fault: Fault) -> str:
        if fault.reason is REFUSED:
            return self._shared.plans[self.node(fault.index).id].binding.refusal
        return told(fault.reason) or "it gave no reason"

    def _failure(self, fault: Fault) -> Failure:
        around: list[Failure] = []
        while fault.cause is not None:
            around.append(self._told(fault))
            fault = fault.cause
        return self._told(fault, tuple(reversed(around)))

    def _told(self, fault: Fault, around: tuple[Failure, ...] = ()) -> Failure:
        index = fault.index
        return Failure(
            index, self.node(index), self.path(index), self._text(fault), fault.exception, self.span(index), around
        )

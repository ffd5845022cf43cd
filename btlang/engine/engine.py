"""A tree that can be ticked."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.build import EngineError, Fault, Shared, Site
from btlang.engine.clock import Clock
from btlang.engine.compile import compile_sites, expand
from btlang.engine.leaf import LeafBinding
from btlang.engine.status import FAILURE, IDLE
from btlang.engine.watch import Trace
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
_FRAMES_ASSUMED = 1500  # which Python is taken to allow, or nearly, without being asked at each tick


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

    Raises EngineError where the tree cannot be compiled. `listener` gets lists of status changes, children before
    parents; see watch.py for what counts as one and when they are told.
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
            self._sites = expand(tree, self.blackboard, self._shared)
            self._trace = None if listener is None else Trace(self._shared, listener)
            self._tick, self._halt = compile_sites(self._sites, self._trace)
        self._frames = _depth(self._sites) * _FRAMES_PER_LEVEL + _FRAMES_FOR_LEAVES
        self._deep = self._frames > _FRAMES_ASSUMED
        self._busy = False
        self.status = IDLE
        self._failed: Failure | None = None  # what failed before a halt

    @property
    def failure(self) -> Failure | None:
        """Why the latest tick failed, also after a halt; None where it did not."""
        if self.status == FAILURE:
            return self._failure(self._shared.fault or Fault(0))
        return self._failed if self.status == IDLE else None

    def tick(self) -> int:
        """Ticks the tree once; returns its status.

        An exception that is no error of a leaf (KeyboardInterrupt, SystemExit) halts the tree and comes through.
        Raises RuntimeError where a leaf or another thread ticks, halts or suspends the tree during a tick.
        """
        if self._deep:
            self._allow_depth()
        if self._busy:  # nothing that could let another thread run stands between this and the next statement
            self._refuse()
        self._busy = True
        try:
            self.status = status = self._tick()
            if self._trace is not None:
                self._trace.tell()
            return status
        except BaseException:
            self._halt_all(False)
            raise
        finally:
            self._busy = False

    def halt(self) -> None:
        """Halts every running leaf, children before parents, and resets all nodes; the next tick starts anew.

        Only a SequenceWithMemory keeps its place, as in BehaviorTree.CPP.
        """
        self._stop(False)

    def suspend(self) -> None:
        """Halts every running leaf but keeps positions, counts and timers; the next tick starts those leaves anew."""
        self._stop(True)

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
        for site in self._sites:
            above = paths[site.above.index] if site.above is not None and site.above.index else ""
            paths.append(f"{above}/{site.position}" if site.above is not None else "/")
        return [(path, site.node) for path, site in zip(paths, self._sites, strict=True)]

    def node(self, index: int) -> Node:
        """The node with an index in preorder."""
        return self._sites[index].node

    def path(self, index: int) -> str:
        """Where a node is: `/` is the root, `/0/1` the second child of its first child; a SubTree's tree is child 0."""
        steps: list[str] = []
        site = self._sites[index]
        while site.above is not None:
            steps.append(str(site.position))
            site = site.above
        return "/" + "/".join(reversed(steps))

    def tell(self) -> None:
        """Hands to the listener what has changed since it was last told; also from within a leaf."""
        if self._trace is not None:
            self._trace.tell()

    def _stop(self, keep: bool) -> None:
        if self._deep:
            self._allow_depth()
        if self._busy:
            self._refuse()
        self._busy = True
        try:
            self._halt_all(keep)
        finally:
            self._busy = False

    def _refuse(self) -> None:
        raise RuntimeError("the tree is being ticked: neither a leaf nor another thread may tick or halt it now")

    def _allow_depth(self) -> None:
        """Others may have set a lower limit since."""
        if sys.getrecursionlimit() < self._frames:
            sys.setrecursionlimit(self._frames)

    def _halt_all(self, keep: bool) -> None:
        """Also when a leaf is interrupted while it halts: it counts as halted then, and another attempt goes on."""
        interrupted: BaseException | None = None
        self._shared.interrupts.clear()
        for _ in self._sites:
            try:
                self._halt(keep)
                break
            except BaseException as exception:
                interrupted = interrupted or exception
        if not keep:
            self._failed = self.failure
            self.status = IDLE
        self.tell()
        if interrupted is not None:
            raise interrupted

    def _failure(self, fault: Fault | Site) -> Failure:
        site = self._sites[fault.index]
        node, sentence = site.node, site
        while sentence.node.span is None and sentence.above is not None:
            sentence = sentence.above
        return Failure(node, self.path(fault.index), fault.reason, fault.exception, sentence.node.span)


def _depth(sites: Sequence[Site]) -> int:
    depths = [0] * len(sites)
    for site in sites:
        if site.above is not None:
            depths[site.index] = depths[site.above.index] + 1
    return max(depths)

"""Traces of statuses, which report changes. They are compiled in only if somebody listens."""

from __future__ import annotations

from _thread import get_ident  # `threading` takes longer to import
from collections.abc import Callable, Iterator, Mapping

from btlang.engine.instance import Fault
from btlang.engine.leaves.callables import FunctionLeaf, fail_with, find_function, status_of
from btlang.engine.status import FAILURE, IDLE, NAMES, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE, ON_SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.instance import Compiled, EngineState, Halt, NodeInstance, Tick
    from btlang.tree.node import Node

    Call: TypeAlias = Callable[[], Any]
    Listener: TypeAlias = Callable[["Changes"], object]


def reports_each_round(node: Node) -> bool:
    """Whether each completion of the node's children is reported: it runs them again after a success, or so many times.

    What it runs until it succeeds, without a limit, is a condition that is waited for.
    """
    kind = CATALOGUE.get(node.id)
    return kind is not None and bool(kind.again) and (kind.again == ON_SUCCESS or not kind.is_endless(node.ports))


def is_rule(node: Node) -> bool:
    """Return whether a node is a rule, whose first child is its condition."""
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.roles[:1] == ("whenever",)


_SUCCESS = tuple(before << 3 | SUCCESS for before in range(len(NAMES)))  # the code of a success, by the status before


class Changes:
    """Changes of statuses, oldest first. Iterating yields for each the index of the node in preorder, its new status,
    the one before (IDLE in a new run of its parent), and for a FAILURE what had failed latest then: this node or one
    below. For the SUCCESS of a condition of a rule it is what was measured, where that is known.

    They are kept as collections of numbers so that a change makes no new object: the garbage collector, which new
    objects call for, took longer than the rest of a tick.
    """

    __slots__ = ("codes", "faults", "indices")

    def __init__(self) -> None:
        self.indices: list[int] = []
        self.codes: list[int] = []
        """The status before and the new one, in 3 bits each from the right."""
        self.faults: dict[int, Fault | NodeInstance | None] = {}  # by the position of the change

    def add(self, index: int, before: int, status: int, fault: Fault | NodeInstance | None = None) -> None:
        """Add one change. `fault` counts if it is a FAILURE."""
        if status is FAILURE:
            self.faults[len(self.codes)] = fault
        self.indices.append(index)
        self.codes.append(before << 3 | status)

    def __len__(self) -> int:
        return len(self.codes)

    def __iter__(self) -> Iterator[tuple[int, int, int, Fault | NodeInstance | None]]:
        for position, (index, code) in enumerate(zip(self.indices, self.codes, strict=True)):
            yield index, code & 7, code >> 3, self.faults.get(position)


class StatusTrace:
    """The trace that all nodes of one engine share: the number of the tick, and the pending status changes.

    The listener gets them together, which costs far less: after each tick, halt and suspension, before a leaf that
    takes time starts and when it has ended, and whenever `flush` is called.
    """

    __slots__ = ("listener", "nodes", "pending", "state", "thread", "tick")

    def __init__(self, state: EngineState, listener: Listener) -> None:
        self.state = state
        self.listener = listener
        self.tick = 0
        self.thread = 0  # that of the latest tick
        self.pending = Changes()
        self.nodes: list[NodeTrace] = []  # in preorder

    def restore(self, statuses: Mapping[int, int]) -> None:
        """Set the statuses that nodes had before the first tick, and report them like any change."""
        for index in sorted(statuses, reverse=True):
            self.nodes[index].last = statuses[index]
            self.pending.add(index, IDLE, statuses[index])
        self.flush()

    def flush(self) -> None:
        """Hand the pending changes to the listener, oldest first."""
        if self.pending.codes:
            changes, self.pending = self.pending, Changes()
            self.listener(changes)


class NodeTrace:
    """The trace of one node, which records each new status; the same status again is no change.

    A completion is a change again after a new run: when a parent that was RUNNING ends, the statuses below it are
    forgotten. So a condition that is polled at every tick is recorded once, and an action in a loop each time. With
    `every`, all completions are: Repeat may repeat a function that completes at once, so no status separates rounds.
    If a node that completed at once is RUNNING when it is ticked again, that is a new run as well: the statuses below
    it from this tick are recorded before its own, and those that this run has not reached are forgotten.
    """

    __slots__ = ("below", "every", "index", "last", "reached", "recorded", "reported_by_leaf", "trace")

    def __init__(self, index: int, every: bool, below: list[NodeTrace], trace: StatusTrace) -> None:
        self.index = index
        self.every = every
        self.below = below
        self.trace = trace
        self.last = IDLE
        self.reached = self.recorded = 0  # the ticks in which it last had a status, and in which that was recorded
        self.reported_by_leaf = False  # so that a leaf needs no wrapper while it is RUNNING

    def change(self, status: int) -> None:
        """Record the status that the node has now."""
        if status != RUNNING and (self.every or self.last == RUNNING):
            self._forget_below()
        elif status == RUNNING and self.last not in (IDLE, RUNNING):
            self._record_below()
        if status != self.last or (self.every and status != RUNNING):
            before = self.last
            self.last = status
            self._record(before)
            if before == RUNNING and not self.below:  # a leaf that took time
                self.trace.flush()

    def flush(self) -> None:
        """Hand the pending changes of the whole engine to the listener."""
        self.trace.flush()

    def ended(self, status: int) -> int:
        """Record the completion of a leaf that reports its own; return the status."""
        if self.reported_by_leaf:
            self.reached = self.trace.tick
            self.change(status)
        return status

    def _record(self, before: int = IDLE) -> None:
        """Add its status to the pending changes; `before` is the one before."""
        trace = self.trace
        self.recorded = trace.tick
        trace.pending.add(self.index, before, self.last, trace.state.fault)

    def wrap(self, compiled: Compiled) -> Compiled:
        """Return the same node, traced. The root counts the ticks."""
        tick, halt = compiled
        leaf = find_function(tick)
        if leaf is not None and self.index and not self.every:
            return self._trace_function(leaf), self._trace_halt(halt)
        if self.reported_by_leaf:
            return tick, self._trace_halt(halt)
        trace = self.trace

        def traced_tick() -> int:
            status = tick()
            self.reached = trace.tick
            if status is not self.last or self.every:
                self.change(status)
            return status

        def root_tick() -> int:
            trace.tick += 1
            trace.thread = get_ident()
            return traced_tick()

        return (traced_tick if self.index else root_tick), self._trace_halt(halt)

    def _trace_function(self, leaf: FunctionLeaf) -> Tick:
        """Wrap the function itself, and do what FunctionLeaf.tick does: the two calls become one."""

        measures = _find_measured(leaf.instance)

        # defaults and not cells, as in control.py: there are many of them
        def traced_tick(
            self: NodeTrace = self,
            call: Call = leaf.call,
            trace: StatusTrace = self.trace,
            after: tuple[int, ...] = _SUCCESS,
            measured: Callable[[], str] | None = measures,
        ) -> int:
            try:
                status = call()
            except KeyboardInterrupt:
                raise
            except BaseException as problem:
                status = fail_with(leaf.instance, problem)
            else:
                if status is None:
                    status = SUCCESS
                elif status is not SUCCESS:
                    status = status_of(leaf.instance, status)
            self.reached = now = trace.tick
            if status is not self.last:
                before, self.last = self.last, status
                if status is SUCCESS:
                    self.recorded = now
                    changes = trace.pending
                    if measured is not None:
                        changes.faults[len(changes.codes)] = Fault(self.index, measured())
                    changes.indices.append(self.index)
                    changes.codes.append(after[before])
                else:
                    self._record(before)
            return status

        return traced_tick

    def _trace_halt(self, halt: Halt) -> Halt:
        def traced_halt(keep: bool) -> None:
            halt(keep)
            if self.last == RUNNING:
                self.change(IDLE)

        return traced_halt

    def _forget_below(self) -> None:
        # a node whose last status is IDLE has nothing to forget below it
        stack = [child for child in self.below if child.last != IDLE]
        while stack:
            node = stack.pop()
            node.last = IDLE
            stack += [child for child in node.below if child.last != IDLE]

    def _record_below(self) -> None:
        """Record the completions of this tick that aren't recorded, children before parents, and forget others."""
        now = self.trace.tick
        unrecorded: list[NodeTrace] = []
        stack = [child for child in self.below if child.last != IDLE]
        while stack:
            node = stack.pop()
            if node.last == RUNNING:  # just recorded, with everything below it
                continue
            if node.reached != now:
                node._forget_below()
                node.last = IDLE
                continue
            if node.recorded != now:
                unrecorded.append(node)
            stack += [child for child in node.below if child.last != IDLE]
        for node in reversed(unrecorded):
            node._record()


_MOST_ABOVE = 4  # nodes between a rule and a condition in it: `not`, `and`, `or`


def _find_measured(instance: NodeInstance) -> Callable[[], str] | None:
    """Return what says what a leaf measured, if it is in the condition of a rule; nobody asks for it elsewhere."""
    signature = instance.state.signatures.get(instance.node.id)
    measured = signature.binding.measured if signature is not None else None
    below, above = instance, instance.above
    for _ in range(_MOST_ABOVE) if measured is not None else ():
        if above is None:
            break
        if is_rule(above.node):
            return measured if below.position == 0 else None
        below, above = above, above.above
    return None

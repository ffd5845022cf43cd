"""Traces of statuses, which report changes. They are compiled in only if somebody listens.

What completes within a tick, as nearly all nodes do, only writes its status into an array, and in a generated region
functions in a row write theirs together (row_trace.py). `StatusTrace.settle` compares the array with the statuses
before, for all nodes at once. So a change costs a few dozen nanoseconds; what takes time, is halted or is repeated
costs more.
"""

from __future__ import annotations

from _thread import get_ident  # `threading` takes longer to import
from collections.abc import Callable, Mapping, Sequence

from btlang.engine.changes import NOTHING, REACHED, Block, Changes, Layout, reports_each_round
from btlang.engine.instance import Fault
from btlang.engine.leaves.callables import FunctionLeaf, fail_with, find_function, status_of
from btlang.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.instance import Compiled, EngineState, NodeInstance, Tick
    from btlang.tree.node import Node

    Call: TypeAlias = Callable[[], Any]
    Listener: TypeAlias = Callable[[Changes], object]


def is_rule(node: Node) -> bool:
    """Return whether a node is a rule, whose first child is its condition."""
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.roles[:1] == ("whenever",)


_STATUS = bytes(each & 7 for each in range(256))  # what takes REACHED off again


class StatusTrace:
    """The trace that all nodes of one engine share: their statuses, the number of the tick, and the pending changes.

    The listener gets them together, which costs far less: after each tick, halt and suspension, before a leaf that
    takes time starts and when it has ended, and whenever `flush` is called.
    """

    __slots__ = (
        "_flushed",
        "_recorded",
        "faults",
        "high",
        "last",
        "layout",
        "listener",
        "low",
        "now",
        "pending",
        "state",
        "thread",
    )

    def __init__(self, state: EngineState, listener: Listener, instances: Sequence[NodeInstance]) -> None:
        self.state = state
        self.listener = listener
        self.thread = 0  # that of the latest tick
        self.layout = Layout(instances)
        self.pending = Changes()
        self.last = bytearray([IDLE]) * len(instances)  # the statuses that are told or pending, by place
        self.now = self.last[:]  # those now, with REACHED
        self.low, self.high = 0, NOTHING  # the places that have been written since both were compared
        self.faults: dict[int, Fault | NodeInstance | None] = {}  # of these, by number
        self._flushed: list[int | Block] = []  # in this tick, which `recorded` hasn't looked at
        self._recorded: set[int] = set()

    def restore(self, statuses: Mapping[int, int]) -> None:
        """Set the statuses that nodes had before the first tick, and report them like any change."""
        for index in sorted(statuses, reverse=True):
            self.last[self.layout.places[index]] = statuses[index]
            self.pending.add(index, IDLE, statuses[index])
        self.now[:] = self.last
        self.flush()

    def begin_tick(self) -> None:
        """Note that nothing has been reached in this tick."""
        self.thread = get_ident()
        self.now[:] = self.last
        if self._flushed or self._recorded:
            self._flushed, self._recorded = [], set()

    def begin(self, place: int) -> None:
        """Go on to write at a place that isn't behind the latest one."""
        if self.high != NOTHING:
            self.settle()
        self.low = place
        self.high = place - 1

    def settle(self) -> None:
        """Add what was written to the pending changes."""
        if self.high == NOTHING:
            return
        low, end = self.low, self.high + 1
        self.high = NOTHING
        before, after = bytes(self.last[low:end]), self.now[low:end].translate(_STATUS)
        if before != after:
            self.last[low:end] = after
            self.pending.add_block(Block(self.layout, low, before, bytes(after), self.faults))
            self.faults = {}

    def flush(self) -> None:
        """Hand the pending changes to the listener, oldest first."""
        if self.high != NOTHING:
            self.settle()
        if self.pending.entries:
            changes, self.pending = self.pending, Changes()
            self._flushed += changes.entries
            self.listener(changes)

    def forget(self, start: int, end: int) -> None:
        """Let nodes be IDLE without reporting it."""
        self.last[start:end] = self.now[start:end] = bytes([IDLE]) * (end - start)

    def recorded(self) -> set[int]:
        """Return the numbers of the nodes whose status was reported in this tick, or is pending."""
        for entry in (*self._flushed, *self.pending.entries):
            self._recorded.update((entry >> 6,) if isinstance(entry, int) else entry.nodes)
        self._flushed.clear()
        return self._recorded


class NodeTrace:
    """The trace of one node, which records each new status; the same status again is no change.

    A completion is a change again after a new run: when a parent that was RUNNING ends, the statuses below it are
    forgotten. So a condition that is polled at every tick is recorded once, and an action in a loop each time. With
    `every`, all completions are: Repeat may repeat a function that completes at once, so no status separates rounds.
    If a node that completed at once is RUNNING when it is ticked again, that is a new run as well: the statuses below
    it from this tick are recorded before its own, and those that this run has not reached are forgotten.
    """

    __slots__ = ("every", "index", "place", "reported_by_leaf", "start", "trace")

    def __init__(self, instance: NodeInstance, trace: StatusTrace) -> None:
        self.index = instance.index
        self.every = instance.above is not None and reports_each_round(instance.above.node)
        self.trace = trace
        self.place = trace.layout.places[self.index]
        self.start = trace.layout.starts[self.place]
        self.reported_by_leaf = False  # so that a leaf needs no wrapper while it is RUNNING

    def change(self, status: int) -> None:
        """Record the status that the node has now."""
        trace, place = self.trace, self.place
        before = trace.last[place]
        if status == RUNNING == before:
            trace.now[place] = RUNNING | REACHED
            return
        trace.settle()
        before = trace.last[place]
        if status != RUNNING and (self.every or before == RUNNING):
            trace.forget(self.start, place)
        elif status == RUNNING and before not in (IDLE, RUNNING):
            self._record_below()
        trace.now[place] = status | REACHED
        if status != before or (self.every and status != RUNNING):
            trace.last[place] = status
            trace.pending.add(self.index, before, status, trace.state.fault if status == FAILURE else None)
            if before == RUNNING and self.start == place:  # a leaf that took time
                trace.flush()

    def flush(self) -> None:
        """Hand the pending changes of the whole engine to the listener."""
        self.trace.flush()

    def ended(self, status: int) -> int:
        """Record the completion of a leaf that reports its own; return the status."""
        if self.reported_by_leaf:
            self.change(status)
        return status

    def complete(self, status: int) -> None:
        """Note the status of a tick, or record it at once where it can't be compared later."""
        trace, place = self.trace, self.place
        before = trace.last[place]
        if status == RUNNING or before == RUNNING or self.every:
            self.change(status)
            return
        if place <= trace.high:
            trace.begin(place)
            before = trace.last[place]
        trace.high = place
        trace.now[place] = status | REACHED
        if not status and before:
            trace.faults[self.index] = trace.state.fault

    def halted(self) -> None:
        """Record that the node was halted, if it was RUNNING."""
        if self.trace.last[self.place] == RUNNING:
            self.change(IDLE)

    def reach(self, status: int) -> None:
        """Note the status that a function has now, to be compared later with the one before."""
        trace, place = self.trace, self.place
        if place <= trace.high:
            trace.begin(place)
        trace.high = place
        trace.now[place] = status | REACHED
        if not status and trace.last[place]:
            trace.faults[self.index] = trace.state.fault

    def wrap(self, compiled: Compiled) -> Compiled:
        """Return the same node, traced. The root counts the ticks."""
        if self.reported_by_leaf:
            return compiled
        tick, halt = compiled
        trace, traced_tick = self.trace, self._trace_tick(tick)

        def root_tick() -> int:
            trace.begin_tick()
            return traced_tick()

        def traced_halt(keep: bool) -> None:
            halt(keep)
            self.halted()

        return (traced_tick if self.index else root_tick), traced_halt

    def _trace_tick(self, tick: Tick) -> Tick:
        every = self.every

        # what doesn't change are defaults: there are many of them
        def traced_tick(
            place: int = self.place,
            trace: StatusTrace = self.trace,
            now: bytearray = self.trace.now,
        ) -> int:
            status = tick()
            if now[place] == status and not every:  # as before, and not reached so far
                now[place] = status | REACHED
                return status
            self.complete(status)
            return status

        return traced_tick

    def wrap_functions(self, children: Sequence[Compiled], keeps: bool) -> list[Compiled]:
        """Return the children of this node, with those traced that are functions. With `keeps` those of which only the
        status is reported stay as they are.
        """
        wrapped = []
        for tick, halt in children:
            leaf = find_function(tick)
            if leaf is None:
                wrapped.append((tick, halt))
                continue
            trace, measured = NodeTrace(leaf.instance, self.trace), _find_measured(leaf.instance)
            if trace.every:
                tick = trace._trace_tick(tick)
            elif measured is not None or not keeps:
                tick = trace._trace_function(leaf, measured)
            wrapped.append((tick, trace.halt_function))
        return wrapped

    def _trace_function(self, leaf: FunctionLeaf, measured: Callable[[], str] | None) -> Tick:
        """Trace the function itself, and do what FunctionLeaf.tick does: the calls become one."""

        # what doesn't change are defaults, as above
        def traced_tick(
            call: Call = leaf.call,
            place: int = self.place,
            trace: StatusTrace = self.trace,
            last: bytearray = self.trace.last,
            now: bytearray = self.trace.now,
            measured: Callable[[], str] | None = measured,
        ) -> int:
            status: int
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
            if now[place] == status:  # as before, and not reached so far
                now[place] = status | REACHED
                return status
            if place <= trace.high:
                trace.begin(place)
            trace.high = place
            now[place] = status | REACHED
            if not status and last[place]:
                trace.faults[self.index] = trace.state.fault
            elif measured is not None and status is SUCCESS != last[place]:
                trace.faults[self.index] = Fault(self.index, measured())
            return status

        return traced_tick

    def halt_function(self, keep: bool) -> None:
        """Halt a function leaf, which knows nothing of it."""
        if self.trace.now[self.place] & ~REACHED == RUNNING:  # it may have completed since `last`
            self.change(IDLE)

    def _record_below(self) -> None:
        """Record the completions of this tick that aren't recorded, children before parents, and forget others."""
        trace = self.trace
        last, now, layout, recorded = trace.last, trace.now, trace.layout, trace.recorded()
        unrecorded: list[int] = []
        place = self.place - 1
        while place >= self.start:
            if last[place] == RUNNING:  # just recorded, with everything below it
                place = layout.starts[place] - 1
            elif last[place] != IDLE and not now[place] & REACHED:
                trace.forget(layout.starts[place], place + 1)
                place = layout.starts[place] - 1
            else:
                if last[place] != IDLE and layout.numbers[place] not in recorded:
                    unrecorded.append(place)
                place -= 1
        for place in reversed(unrecorded):
            trace.pending.add(layout.numbers[place], IDLE, last[place], trace.state.fault)


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

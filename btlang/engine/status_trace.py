"""Traces of statuses, which report changes. They are compiled in only if somebody listens.

What completes within a tick, as nearly all nodes do, only writes its status into an array, and functions below one node
write theirs together. `StatusTrace.settle` compares the array with the statuses before, for all nodes at once. So a
change costs a few dozen nanoseconds; what takes time, is halted or is repeated costs more.
"""

from __future__ import annotations

from _thread import get_ident  # `threading` takes longer to import
from collections.abc import Callable, Mapping, Sequence

from btlang.engine.changes import Block, Changes, Layout, reports_each_round
from btlang.engine.instance import Fault
from btlang.engine.leaves.callables import FunctionLeaf, find_function
from btlang.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.instance import Compiled, EngineState, Halt, NodeInstance, Tick
    from btlang.tree.node import Node

    Call: TypeAlias = Callable[[], Any]
    Listener: TypeAlias = Callable[[Changes], object]


def is_rule(node: Node) -> bool:
    """Return whether a node is a rule, whose first child is its condition."""
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.roles[:1] == ("whenever",)


_REACHED = 8
"""Added to the status of a node that has got it in the present tick."""
_STATUS = bytes(each & 7 for each in range(256))  # what takes it off again
_NOTHING = 1 << 60  # higher than any place: nothing waits to be compared


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
        "open",
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
        self.now = self.last[:]  # those now, with _REACHED
        self.low, self.high = 0, _NOTHING  # the places that have been written since both were compared
        self.faults: dict[int, Fault | NodeInstance | None] = {}  # of these, by number
        self.open: list[Callable[[], None]] = []  # for nodes with functions that are being ticked: what writes theirs
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
        self.open.clear()
        self.settle()
        self.now[:] = self.last
        self._flushed.clear()
        self._recorded.clear()

    def begin(self, place: int) -> None:
        """Go on to write at a place that isn't behind the latest one."""
        self.settle()
        self.low = place
        self.high = place - 1

    def settle(self) -> None:
        """Add what was written to the pending changes."""
        for write in self.open:
            write()
        if self.high == _NOTHING:
            return
        low, end = self.low, self.high + 1
        self.high = _NOTHING
        before, after = bytes(self.last[low:end]), self.now[low:end].translate(_STATUS)
        if before != after:
            self.last[low:end] = after
            self.pending.add_block(Block(self.layout, low, before, bytes(after), self.faults))
            self.faults = {}

    def flush(self) -> None:
        """Hand the pending changes to the listener, oldest first."""
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

    __slots__ = ("every", "index", "place", "reported_by_leaf", "start", "trace", "write")

    def __init__(self, instance: NodeInstance, trace: StatusTrace) -> None:
        self.index = instance.index
        self.every = instance.above is not None and reports_each_round(instance.above.node)
        self.trace = trace
        self.place = trace.layout.places[self.index]
        self.start = trace.layout.starts[self.place]
        self.reported_by_leaf = False  # so that a leaf needs no wrapper while it is RUNNING
        self.write: Callable[[], None] | None = None  # writes what functions below it have answered so far

    def change(self, status: int, measured: Fault | None = None) -> None:
        """Record the status that the node has now."""
        trace, place = self.trace, self.place
        before = trace.last[place]
        if status == RUNNING == before:
            trace.now[place] = RUNNING | _REACHED
            return
        trace.settle()
        before = trace.last[place]
        if status != RUNNING and (self.every or before == RUNNING):
            trace.forget(self.start, place)
        elif status == RUNNING and before not in (IDLE, RUNNING):
            self._record_below()
        trace.now[place] = status | _REACHED
        if status != before or (self.every and status != RUNNING):
            trace.last[place] = status
            trace.pending.add(self.index, before, status, trace.state.fault if status == FAILURE else measured)
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

    def reach(self, status: int, measured: Fault | None = None) -> None:
        """Note the status that a function has now, to be compared later with the one before."""
        trace, place = self.trace, self.place
        if self.every:
            self.change(status, measured)
            return
        if place <= trace.high:
            trace.begin(place)
        trace.high = place
        trace.now[place] = status | _REACHED
        if not status and trace.last[place]:
            trace.faults[self.index] = trace.state.fault
        elif measured is not None:
            trace.faults[self.index] = measured

    def wrap(self, compiled: Compiled) -> Compiled:
        """Return the same node, traced. The root counts the ticks."""
        tick, halt = compiled
        trace = self.trace
        if self.reported_by_leaf:
            return tick, self._trace_halt(halt)
        traced_tick = self._trace_tick(tick)

        def root_tick() -> int:
            trace.begin_tick()
            return traced_tick()

        return (traced_tick if self.index else root_tick), self._trace_halt(halt)

    def _trace_tick(self, tick: Tick) -> Tick:
        every, start, write = self.every, self.start, self.write

        # what doesn't change are defaults: there are many of them
        def traced_tick(
            place: int = self.place,
            trace: StatusTrace = self.trace,
            last: bytearray = self.trace.last,
            opened: list[Callable[[], None]] = self.trace.open,
        ) -> int:
            if write is None:
                status = tick()
            else:
                if start <= trace.high:
                    trace.begin(start)
                opened.append(write)
                status = tick()
                opened.pop()
            before = last[place]
            if status == RUNNING or before == RUNNING or every:
                self.change(status)
                return status
            if place <= trace.high:
                trace.begin(place)
                before = last[place]
            trace.high = place
            trace.now[place] = status | _REACHED
            if not status and before:
                trace.faults[self.index] = trace.state.fault
            return status

        return traced_tick

    def wrap_functions(self, children: Sequence[Compiled], keeps: bool) -> list[Compiled]:
        """Return the children of this node, with those traced that are functions; where it `keeps` them as they are,
        it traces what they answer (`trace_functions`).
        """
        wrapped = []
        for tick, halt in children:
            leaf = find_function(tick)
            if leaf is None:
                wrapped.append((tick, halt))
                continue
            trace, measured = NodeTrace(leaf.instance, self.trace), _find_measured(leaf.instance)
            if measured is not None:
                tick = trace._trace_measured(leaf, measured)
            elif not keeps:
                tick = trace._trace_tick(tick)
            wrapped.append((tick, trace.halt_function))
        return wrapped

    def trace_functions(self, leaves: Sequence[FunctionLeaf | None], passes: int) -> FunctionsTrace | None:
        """Return the trace of the functions among the children of this node, which are None else."""
        if not any(leaves):
            return None
        traces = [None if leaf is None else NodeTrace(leaf.instance, self.trace) for leaf in leaves]
        return FunctionsTrace(self, traces, passes)

    def _trace_measured(self, leaf: FunctionLeaf, measured: Callable[[], str]) -> Tick:
        def traced_tick() -> int:
            status = leaf.tick()
            is_new = status == SUCCESS != self.trace.last[self.place]
            self.reach(status, Fault(self.index, measured()) if is_new else None)
            return status

        return traced_tick

    def halt_function(self, keep: bool) -> None:
        """Halt a function leaf, which knows nothing of it."""
        if self.trace.now[self.place] & ~_REACHED == RUNNING:  # it may have completed since `last`
            self.change(IDLE)

    def _trace_halt(self, halt: Halt) -> Halt:
        def traced_halt(keep: bool) -> None:
            halt(keep)
            if self.trace.last[self.place] == RUNNING:
                self.change(IDLE)

        return traced_halt

    def _record_below(self) -> None:
        """Record the completions of this tick that aren't recorded, children before parents, and forget others."""
        trace = self.trace
        last, now, layout, recorded = trace.last, trace.now, trace.layout, trace.recorded()
        unrecorded: list[int] = []
        place = self.place - 1
        while place >= self.start:
            if last[place] == RUNNING:  # just recorded, with everything below it
                place = layout.starts[place] - 1
            elif last[place] != IDLE and not now[place] & _REACHED:
                trace.forget(layout.starts[place], place + 1)
                place = layout.starts[place] - 1
            else:
                if last[place] != IDLE and layout.numbers[place] not in recorded:
                    unrecorded.append(place)
                place -= 1
        for place in reversed(unrecorded):
            trace.pending.add(layout.numbers[place], IDLE, last[place], trace.state.fault)


class FunctionsTrace:
    """The trace of the functions below a node that calls them itself and goes on at one status, `passes`."""

    __slots__ = ("_above", "_block", "_first", "_leaves", "_passes", "_places", "_trace", "asked", "marked")

    def __init__(self, above: NodeTrace, leaves: Sequence[NodeTrace | None], passes: int) -> None:
        self._above, self._trace, self._passes = above, above.trace, passes
        self._leaves = leaves
        self._places = tuple([-1 if leaf is None else leaf.place for leaf in leaves])
        self._first = self._places[0]
        alone = -1 not in self._places
        self._block = bytes([passes | _REACHED]) * len(leaves) if alone else b""
        self.marked = 0
        """The first child whose status isn't written."""
        self.asked = 0
        """The child that is being ticked, where the node doesn't know it itself."""

    def follow(self, present: Callable[[], int]) -> None:
        """Let `present` say at any time which child is being ticked."""
        self._above.write = lambda: self.write(present())

    def write(self, end: int) -> None:
        """Write the statuses of the children up to a number: they have passed."""
        begin = self.marked
        if begin >= end:
            return
        self.marked = end
        trace = self._trace
        if self._block:
            first = self._first + begin
            latest = self._first + end - 1
            trace.now[first : latest + 1] = self._block[begin:end]
        else:
            places = [place for place in self._places[begin:end] if place >= 0]
            if not places:
                return
            first, latest = places[0], places[-1]
            now, status = trace.now, self._passes | _REACHED
            for place in places:
                now[place] = status
        high = trace.high
        if high == _NOTHING:
            trace.low, trace.high = first, latest
        else:
            if latest > high:
                trace.high = latest
            if first < trace.low:  # it came before what is written, but wasn't
                trace.low = first

    def decide(self, child: int, status: int) -> None:
        """Write the statuses up to a child, and that of this one, if it's a function."""
        self.write(child + 1)
        leaf = self._leaves[child]
        if leaf is not None:
            self._trace.now[leaf.place] = status | _REACHED
            if not status and self._trace.last[leaf.place]:
                self._trace.faults[leaf.index] = self._trace.state.fault

    def write_one(self, child: int, status: int) -> None:
        """Write the status of one child, if it's a function."""
        leaf = self._leaves[child]
        if leaf is not None:
            leaf.reach(status)


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

"""Traces functions below one node together: what ticks them calls them itself (see fused.py)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.changes import NOTHING, REACHED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    from btlang.engine.instance import EngineState, Fault, NodeInstance

    class Trace(Protocol):
        """The part of StatusTrace that is used here; see status_trace.py."""

        state: EngineState
        last: bytearray
        now: bytearray
        low: int
        high: int
        faults: dict[int, Fault | NodeInstance | None]

    class TracedNode(Protocol):
        """The part of NodeTrace that is used here."""

        index: int
        place: int
        write: Callable[[], None] | None

        @property
        def trace(self) -> Trace: ...

        def reach(self, status: int) -> None: ...


class FunctionsTrace:
    """The trace of the functions below a node that calls them itself and goes on at one status, `passes`."""

    __slots__ = (
        "_above",
        "_block",
        "_first",
        "_leaves",
        "_passes",
        "_places",
        "_trace",
        "_unchanged",
        "asked",
        "marked",
    )

    def __init__(self, above: TracedNode, leaves: Sequence[TracedNode | None], passes: int) -> None:
        self._above, self._trace, self._passes = above, above.trace, passes
        self._leaves = leaves
        self._places = tuple([-1 if leaf is None else leaf.place for leaf in leaves])
        self._first = self._places[0]
        alone = -1 not in self._places
        self._block = bytes([passes | REACHED]) * len(leaves) if alone else b""
        self._unchanged = bytes([passes]) * len(leaves)
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
            unchanged = trace.now[first : latest + 1] == self._unchanged[begin:end]  # and not reached so far
            trace.now[first : latest + 1] = self._block[begin:end]
            if unchanged:
                return
        else:
            places = [place for place in self._places[begin:end] if place >= 0]
            if not places:
                return
            first, latest = places[0], places[-1]
            now, status = trace.now, self._passes | REACHED
            for place in places:
                now[place] = status
        high = trace.high
        if high == NOTHING:
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
            self._trace.now[leaf.place] = status | REACHED
            if not status and self._trace.last[leaf.place]:
                self._trace.faults[leaf.index] = self._trace.state.fault

    def write_one(self, child: int, status: int) -> None:
        """Write the status of one child, if it's a function."""
        leaf = self._leaves[child]
        if leaf is not None:
            leaf.reach(status)

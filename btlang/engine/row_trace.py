"""Traces functions in a row in a generated region, whose statuses are written together (see regions.py)."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.changes import REACHED
from btlang.engine.instance import NodeInstance
from btlang.engine.status import IDLE, RUNNING
from btlang.engine.status_trace import NodeTrace, StatusTrace

_BYTES = [bytes([status]) for status in range(2 * REACHED)]


class RowTrace:
    """The trace of functions in a row. Each of them passes, or has another status."""

    __slots__ = ("_first", "_instances", "_passed", "_reached", "_trace")

    def __init__(self, trace: StatusTrace, instances: Sequence[NodeInstance], passes: int) -> None:
        self._trace = trace
        self._first = trace.layout.places[instances[0].index]  # the next one's is the next
        self._instances = instances
        self._passed = bytes([passes]) * len(instances)
        self._reached = bytes([passes | REACHED]) * len(instances)

    @property
    def whole(self) -> tuple[slice, bytes, bytes]:
        """The places of all, and what is there if they have passed: before they are reached again, and then."""
        return slice(self._first, self._first + len(self._passed)), self._passed, self._reached

    def passed(self, begin: int, end: int) -> None:
        """Write that those from one number up to another have passed."""
        trace, first, behind = self._trace, self._first + begin, self._first + end
        now = trace.now
        is_same = now[first:behind] == self._passed[begin:end]  # and not reached so far
        now[first:behind] = self._reached[begin:end]
        if not is_same:
            if first <= trace.high:
                trace.begin(first)
            trace.high = behind - 1

    def decided(self, number: int, status: int) -> None:
        """Write that all before one have passed, and its status."""
        if not number:
            self.answered(0, status)
            return
        trace, first, last = self._trace, self._first, self._first + number
        now = trace.now
        if now[first : last + 1] != self._passed[:number] + _BYTES[status]:  # else as before, and not reached so far
            if first <= trace.high:
                trace.begin(first)
            trace.high = last
            if not status and trace.last[last]:
                trace.faults[self._instances[number].index] = trace.state.fault
        now[first : last + 1] = self._reached[:number] + _BYTES[status | REACHED]

    def answered(self, number: int, status: int) -> None:
        """Write the status of one."""
        trace, place = self._trace, self._first + number
        if trace.now[place] != status:  # else as before, and not reached so far
            if place <= trace.high:
                trace.begin(place)
            trace.high = place
            if not status and trace.last[place]:
                trace.faults[self._instances[number].index] = trace.state.fault
        trace.now[place] = status | REACHED

    def halted(self, number: int) -> None:
        """Record that one was halted, if it was RUNNING."""
        if self._trace.now[self._first + number] & ~REACHED == RUNNING:
            NodeTrace(self._instances[number], self._trace).change(IDLE)

    def all_halted(self) -> None:
        """Record that all were halted."""
        for number in range(len(self._instances)):
            self.halted(number)

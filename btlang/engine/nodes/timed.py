"""Nodes that wait for the clock: timeout_node.cpp, delay_node.cpp and sleep_node.cpp of BehaviorTree.CPP 4.10.

The clock is read when they are ticked, and asked for a tick when their time is over; C++ has a timer thread instead. A
Timeout whose child is SKIPPED restarts its time; in C++ it goes on, or ends, by chance.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.clock import SOONEST, Clock
from btlang.engine.instance import NodeInstance
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import value_port
from btlang.engine.script.values import as_text
from btlang.engine.status import RUNNING, SKIPPED, SUCCESS
from btlang.text.time_of_day import DAY, seconds_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled

_SLACK = 1e-9  # twenty ticks of 0.05 s are 1 s, whatever floating point makes of their sum


class Stopwatch:
    """A stopwatch that runs from its first reading; `halt(keep)` pauses or resets it."""

    __slots__ = ("clock", "kept", "since")

    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.kept = 0.0
        self.since: float | None = None

    def reached(self, msec: float) -> bool:
        """Whether so much time has passed."""
        if self.since is None:
            self.since = self.clock.now
        return self.kept + self.clock.now - self.since >= msec / 1000 - _SLACK

    def wait(self, msec: float) -> int:
        """Return RUNNING, and ask for a tick when so much time has passed since it began; at most a thousand a
        second.
        """
        assert self.since is not None
        self.clock.wake_at(self.since + max(msec / 1000, SOONEST) - self.kept)
        return RUNNING

    def saved(self) -> float:
        """Return the seconds that it has run."""
        return self.kept + (0.0 if self.since is None else self.clock.now - self.since)

    def restore(self, seconds: float) -> None:
        """Set the seconds that it has run, and pause it."""
        self.kept, self.since = seconds, None

    def halt(self, keep: bool) -> None:
        if not keep:
            self.kept = 0.0
        elif self.since is not None:
            self.kept += self.clock.now - self.since
        self.since = None


def sleep(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return RUNNING until msec have passed, then SUCCESS."""
    msec = instance.number("msec")
    stopwatch = Stopwatch(instance.state.clock)

    def tick() -> int:
        time = msec()
        if not stopwatch.reached(time):
            return stopwatch.wait(time)
        stopwatch.halt(False)
        return SUCCESS

    return tick, stopwatch.halt


def wait_for_time(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return RUNNING until the clock next shows the time, then SUCCESS. If it shows it at the start, that is tomorrow.

    The clock may be set: what is skipped by that has come, and what is set back is waited for.
    """
    time = value_port(instance, "time", _time_of_day)
    clock = instance.state.clock
    wanted = 0.0
    due: float | None = None

    def tick() -> int:
        nonlocal wanted, due
        if due is None:
            wanted = time()
        left = DAY - (round(clock.time_of_day, 3) - wanted) % DAY
        coming = clock.now + left
        if due is not None and coming > due + DAY / 2:  # the next one is another one: this one has come
            due = None
            return SUCCESS
        due = coming
        clock.wake_at(clock.now + max(left, SOONEST))
        return RUNNING

    def halt(keep: bool) -> None:
        nonlocal due
        if not keep:
            due = None

    return tick, halt


def _time_of_day(value: Any) -> float:
    try:
        return seconds_of(as_text(value))
    except ValueError as problem:
        raise ActionFailed(f"time {problem}") from None


def delay(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return RUNNING until delay_msec have passed, then run its child. A SKIPPED child is ticked again at once."""
    [(child, halt_child)] = children
    msec = instance.number("delay_msec")
    stopwatch = Stopwatch(instance.state.clock)

    def tick() -> int:
        time = msec()
        if not stopwatch.reached(time):
            return stopwatch.wait(time)
        status = child()
        if status != RUNNING and status != SKIPPED:
            stopwatch.halt(False)
        return status

    def halt(keep: bool) -> None:
        halt_child(keep)
        stopwatch.halt(keep)

    return tick, halt


def timeout(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its child; if it is still RUNNING when msec have passed, halt it, not tick it again: FAILURE. 0: no limit."""
    [(child, halt_child)] = children
    msec = instance.number("msec")
    stopwatch = Stopwatch(instance.state.clock)

    def tick() -> int:
        limit = msec()
        if limit and stopwatch.reached(limit):
            halt(False)
            return fail_late(instance, limit)
        status = child()
        if status != RUNNING:
            stopwatch.halt(False)
        elif limit:
            stopwatch.wait(limit)
        return status

    def halt(keep: bool) -> None:
        halt_child(keep)
        stopwatch.halt(keep)

    return tick, halt


def fail_late(instance: NodeInstance, msec: float) -> int:
    """Record that the time of a Timeout is over; return FAILURE."""
    return instance.fail(f"took longer than {msec / 1000:g} s")

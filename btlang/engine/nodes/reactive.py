"""Nodes that ask their children again at every tick; reactive_sequence.cpp and reactive_fallback.cpp of 4.10.

One difference from BehaviorTree.CPP: there, the running child is halted after another one has become RUNNING, so for a
moment two actions drive the robot. Here it is halted before a generator or class leaf starts under another child.
Functions run without halting anything.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance, apart
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def reactive_sequence(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """From the first child at every tick, until one fails; a child that is RUNNING or fails halts the others."""
    return _reactive(instance, children, SUCCESS)


def reactive_fallback(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """From the first child at every tick, until one succeeds; a child that is RUNNING or succeeds halts the others."""
    return _reactive(instance, children, FAILURE)


def _reactive(instance: NodeInstance, children: Sequence[Compiled], passes: int) -> Compiled:
    """Goes on to the next child at the status `passes`, and returns it after the last child. SKIPPED if all are."""
    ticks, halts = apart(children)
    pairs, count = tuple(enumerate(ticks)), len(ticks)
    interrupts = instance.state.interrupts
    running = -1  # the child that was RUNNING at the last tick
    asked = 0  # the child that is being ticked

    def interrupt() -> None:
        nonlocal running
        if asked < running:
            child, running = running, -1
            halts[child](False)

    def tick() -> int:
        nonlocal running, asked
        if running > 0:
            interrupts.append(interrupt)
        skipped = 0
        status = passes
        for asked, child in pairs:
            status = child()
            if status == SKIPPED:
                halts[asked](False)
                skipped += 1
            elif status is not passes:
                break
        if interrupts and interrupts[-1] is interrupt:
            interrupts.pop()
        if status is not passes and status != SKIPPED:
            if asked < running:
                if status is FAILURE:
                    instance.pass_on("its guard failed on the way")
                halts[running](False)
            running = asked if status == RUNNING else -1
            return status
        running = -1
        return SKIPPED if skipped == count else passes

    def halt(keep: bool) -> None:
        nonlocal running
        for stop in halts:
            stop(keep)
        if not keep:
            running = -1

    return tick, halt

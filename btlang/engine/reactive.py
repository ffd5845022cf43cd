"""Nodes that ask their children again at every tick; reactive_sequence.cpp and reactive_fallback.cpp of 4.10.

One difference from BehaviorTree.CPP: there, the running child is halted after another one has become RUNNING, so for a
moment two actions drive the robot. Here it is halted before a generator or class leaf starts under another child.
Functions run without halting anything.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.build import Site, apart
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


def reactive_sequence(site: Site, children: Sequence[Compiled]) -> Compiled:
    """From the first child at every tick, until one fails; a child that is RUNNING or fails halts the others."""
    return _reactive(site, children, SUCCESS)


def reactive_fallback(site: Site, children: Sequence[Compiled]) -> Compiled:
    """From the first child at every tick, until one succeeds; a child that is RUNNING or succeeds halts the others."""
    return _reactive(site, children, FAILURE)


def _reactive(site: Site, children: Sequence[Compiled], passes: int) -> Compiled:
    """Goes on to the next child at the status `passes`, and returns it after the last child. SKIPPED if all are."""
    ticks, halts = apart(children)
    count = len(ticks)
    interrupts = site.shared.interrupts
    running = -1  # the child that was RUNNING at the last tick

    def interrupt() -> None:
        nonlocal running
        child, running = running, -1
        halts[child](False)

    def tick() -> int:
        nonlocal running
        if running > 0:  # it is on the list while children before it are ticked
            interrupts.append(interrupt)
        skipped = 0
        for index, child in enumerate(ticks):
            if index == running > 0:
                interrupts.pop()
            status = child()
            if status == passes:
                continue
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
                continue
            if index < running:
                interrupts.pop()()
                if status == FAILURE:
                    site.pass_on("its guard broke on the way")
            running = index if status == RUNNING else -1
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

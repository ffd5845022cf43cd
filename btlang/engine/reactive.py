"""Nodes that ask their children again at every tick; reactive_sequence.cpp and reactive_fallback.cpp of 4.10.

One difference from BehaviorTree.CPP: there, the running child is halted after another one has become RUNNING, so for a
moment two actions drive the robot. Here it is halted before a generator or class leaf starts under another child.
Functions run without halting anything.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.build import Site
from btlang.engine.row import row, settle
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
    ticks, halts, sites = row(children)
    pairs, count = tuple(enumerate(ticks)), len(ticks)
    interrupts = site.shared.interrupts
    fails = SUCCESS if passes is FAILURE else FAILURE
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
        plain = -1  # the latest child that passed, where nothing has settled what it answered
        status = passes
        for asked, child in pairs:
            try:
                status = child()
                if status is passes:
                    plain = asked
                    continue
                if status != RUNNING and status != SKIPPED:
                    status = settle(sites[asked], status)
            except KeyboardInterrupt:
                raise
            except BaseException as problem:
                status = settle(sites[asked], problem)
            if status is passes:
                plain = -1
            elif status == SKIPPED:
                halts[asked](False)
                skipped += 1
            else:
                break
        if interrupts and interrupts[-1] is interrupt:
            interrupts.pop()
        if status is fails or status == RUNNING:
            if asked < running:
                if status is FAILURE:
                    site.pass_on("its guard broke on the way")
                halts[running](False)
            running = -1 if status is fails else asked
            return status
        running = -1
        if skipped == count:
            return SKIPPED
        if passes is FAILURE and plain >= 0:
            settle(sites[plain], FAILURE)
        return passes

    def halt(keep: bool) -> None:
        nonlocal running
        for stop in halts:
            stop(keep)
        if not keep:
            running = -1

    return tick, halt

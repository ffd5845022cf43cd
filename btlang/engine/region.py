"""Resumes what is RUNNING without asking all that is above it.

A node that waits, such as a Sequence, does nothing while its child is RUNNING but ask that child. Such nodes below each
other form a region: the node at its top asks the child that was RUNNING below the lowest of them, and only when that
completes goes down the long way, where the child gives the status that it has already returned.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.status import RUNNING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled, Site, Tick


class Region:
    """`top` is the number of the highest node, `resumed` the tick of the child that is RUNNING."""

    __slots__ = ("answer", "resumed", "top", "used")

    def __init__(self, top: int) -> None:
        self.top = top
        self.used = False  # whether there is a child for which it is worth the effort
        self.resumed: Tick | None = None
        self.answer: int | None = None  # what that child has returned in this tick


def regions(sites: Sequence[Site], waits: Callable[[Site], bool]) -> list[Region | None]:
    """For each node the region that it is a part of, None for a node that does more than wait."""
    found: list[Region | None] = []
    for site in sites:
        if not waits(site):
            found.append(None)
            continue
        around = None if site.above is None else found[site.above.index]
        found.append(Region(site.index) if around is None else around)
    return found


def below(region: Region, compiled: Compiled) -> Compiled:
    """A node below the region that may be RUNNING for more than a tick."""
    tick, halt = compiled
    region.used = True

    def resumable() -> int:
        status = region.answer
        if status is None:
            status = tick()
        region.answer = None
        region.resumed = tick if status == RUNNING else None
        return status

    def halt_resumable(keep: bool) -> None:
        region.answer = region.resumed = None
        halt(keep)

    return resumable, halt_resumable


def at_top(region: Region, compiled: Compiled) -> Compiled:
    """The highest node of the region."""
    tick, halt = compiled

    def resume() -> int:
        if region.resumed is not None:
            status = region.resumed()
            if status == RUNNING:
                return RUNNING
            region.answer = status
        return tick()

    return resume, halt

"""Reports status changes of one node. Compiled in only where somebody listens."""

from __future__ import annotations

from collections.abc import Callable

from btlang.engine.status import IDLE, RUNNING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.engine.build import Compiled

    Listener: TypeAlias = Callable[[int, int], None]


class Watch:
    """Tells a listener the index and the new status of a node; a status that it has just told is no news.

    A completion is news again after a new run: when a parent that was RUNNING ends, what is below it is forgotten.
    So a condition polled at every tick is told once, and an action in a loop is told each time. `every` tells all
    completions: what Repeat repeats may be a function that completes at once, whose rounds no status tells apart.
    """

    __slots__ = ("below", "every", "index", "last", "listener")

    def __init__(self, index: int, listener: Listener, every: bool) -> None:
        self.index = index
        self.listener = listener
        self.every = every
        self.last = IDLE
        self.below: list[Watch] = []

    def change(self, status: int) -> None:
        """The node has this status now."""
        if status != RUNNING and (self.every or self.last == RUNNING):
            self._forget_below()
        if status != self.last or (self.every and status != RUNNING):
            self.last = status
            self.listener(self.index, status)

    def wrap(self, compiled: Compiled) -> Compiled:
        """The same node, watched."""
        tick, halt = compiled

        def watched_tick() -> int:
            status = tick()
            if status != self.last or self.every:
                self.change(status)
            return status

        def watched_halt(keep: bool) -> None:
            halt(keep)
            if self.last == RUNNING:
                self.change(IDLE)

        return watched_tick, watched_halt

    def _forget_below(self) -> None:
        # a node whose last status is IDLE has nothing to forget below it
        stack = [child for child in self.below if child.last != IDLE]
        while stack:
            watch = stack.pop()
            watch.last = IDLE
            stack += [child for child in watch.below if child.last != IDLE]

"""Reports status changes of one node. Compiled in only where somebody listens."""

from __future__ import annotations

from collections.abc import Callable

from btlang.engine.status import IDLE, RUNNING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.engine.build import Compiled
    from btlang.tree.node import Node

    Listener: TypeAlias = Callable[[int, int], None]

_REPEATING = frozenset(("Repeat", "KeepRunningUntilFailure", "LoopInt", "LoopBool", "LoopDouble", "LoopString"))
_LIMITS = {"RetryUntilSuccessful": "num_attempts", "RecoveryNode": "number_of_retries"}


def repeats(node: Node) -> bool:
    """Whether each completion of the node's children is told: it runs them again after a success, or so many times.

    What it runs until it succeeds, without a limit, is a condition that is waited for.
    """
    return node.id in _REPEATING or (node.id in _LIMITS and node.port(_LIMITS[node.id]) != "-1")


class Watch:
    """Tells a listener the index and the new status of a node; a status that it has just told is no news.

    A completion is news again after a new run: when a parent that was RUNNING ends, what is below it is forgotten.
    So a condition polled at every tick is told once, and an action in a loop is told each time. `every` tells all
    completions: what Repeat repeats may be a function that completes at once, whose rounds no status tells apart.
    Where a node that completed at once is RUNNING when it is ticked again, that is a new run as well: before it is
    told, so are the statuses below it that are those of the run before; what this run has not reached is forgotten.

    `ticks` holds one number, that of the tick; the root counts it up.
    """

    __slots__ = ("below", "every", "index", "last", "listener", "reached", "ticks", "told")

    def __init__(self, index: int, listener: Listener, every: bool, ticks: list[int]) -> None:
        self.index = index
        self.listener = listener
        self.every = every
        self.ticks = ticks
        self.last = IDLE
        self.reached = self.told = 0  # the ticks in which it last had a status, and in which that was told
        self.below: list[Watch] = []

    def change(self, status: int) -> None:
        """The node has this status now."""
        if status != RUNNING and (self.every or self.last == RUNNING):
            self._forget_below()
        elif status == RUNNING and self.last not in (IDLE, RUNNING):
            self._tell_below()
        if status != self.last or (self.every and status != RUNNING):
            self.last = status
            self.told = self.ticks[0]
            self.listener(self.index, status)

    def wrap(self, compiled: Compiled) -> Compiled:
        """The same node, watched."""
        tick, halt = compiled
        ticks = self.ticks

        def watched_tick() -> int:
            status = tick()
            self.reached = ticks[0]
            if status != self.last or self.every:
                self.change(status)
            return status

        def root_tick() -> int:
            ticks[0] += 1
            return watched_tick()

        def watched_halt(keep: bool) -> None:
            halt(keep)
            if self.last == RUNNING:
                self.change(IDLE)

        return (watched_tick if self.index else root_tick), watched_halt

    def _forget_below(self) -> None:
        # a node whose last status is IDLE has nothing to forget below it
        stack = [child for child in self.below if child.last != IDLE]
        while stack:
            watch = stack.pop()
            watch.last = IDLE
            stack += [child for child in watch.below if child.last != IDLE]

    def _tell_below(self) -> None:
        """Tells the completions of this tick that have not been told, children before parents, and forgets others."""
        now = self.ticks[0]
        untold: list[Watch] = []
        stack = [child for child in self.below if child.last != IDLE]
        while stack:
            watch = stack.pop()
            if watch.last == RUNNING:  # it has just told, and with it what is below it
                continue
            if watch.reached != now:
                watch._forget_below()
                watch.last = IDLE
                continue
            if watch.told != now:
                untold.append(watch)
            stack += [child for child in watch.below if child.last != IDLE]
        for watch in reversed(untold):
            watch.told = now
            watch.listener(watch.index, watch.last)

"""Reports status changes. Compiled in only where somebody listens."""

from __future__ import annotations

from _thread import get_ident  # `threading` takes longer to import
from collections.abc import Callable, Iterator

from btlang.engine.leaves import FunctionLeaf, as_function, status_of, unanswered
from btlang.engine.status import FAILURE, IDLE, NAMES, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE, ON_SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.build import Compiled, Fault, Halt, Shared, Site, Tick
    from btlang.tree.node import Node

    Call: TypeAlias = Callable[[], Any]
    Listener: TypeAlias = Callable[["Changes"], object]


def repeats(node: Node) -> bool:
    """Whether each completion of the node's children is told: it runs them again after a success, or so many times.

    What it runs until it succeeds, without a limit, is a condition that is waited for.
    """
    kind = CATALOGUE.get(node.id)
    return kind is not None and bool(kind.again) and (kind.again == ON_SUCCESS or not kind.is_endless(node))


_SUCCESS = tuple(before << 3 | SUCCESS for before in range(len(NAMES)))  # the code of a success, by the status before


class Changes:
    """Changes of statuses, oldest first. Iterating gives for each the index of the node in preorder, its new status,
    the one before (IDLE in a new run of its parent), and for a FAILURE what had failed latest then: this node or one
    below.

    They are kept as collections of numbers so that a change makes no new object: the garbage collector, which new
    objects call for, took longer than the rest of a tick.
    """

    __slots__ = ("codes", "faults", "indices")

    def __init__(self) -> None:
        self.indices: list[int] = []
        self.codes: list[int] = []
        """The status before and the new one, in 3 bits each from the right."""
        self.faults: dict[int, Fault | Site | None] = {}  # by the position of the change

    def add(self, index: int, before: int, status: int, fault: Fault | Site | None = None) -> None:
        """One more. `fault` counts where it is a FAILURE."""
        if status is FAILURE:
            self.faults[len(self.codes)] = fault
        self.indices.append(index)
        self.codes.append(before << 3 | status)

    def __len__(self) -> int:
        return len(self.codes)

    def __iter__(self) -> Iterator[tuple[int, int, int, Fault | Site | None]]:
        for position, (index, code) in enumerate(zip(self.indices, self.codes, strict=True)):
            yield index, code & 7, code >> 3, self.faults.get(position)


class Trace:
    """What the watches of one engine share: the number of the tick, and the changes that have not been told yet.

    They are told together, which costs a listener far less: after each tick, halt and suspension, before a leaf that
    takes time starts and when it has ended, and whenever somebody calls `tell`.
    """

    __slots__ = ("changes", "listener", "shared", "thread", "tick")

    def __init__(self, shared: Shared, listener: Listener) -> None:
        self.shared = shared
        self.listener = listener
        self.tick = 0
        self.thread = 0  # that of the latest tick
        self.changes = Changes()

    def tell(self) -> None:
        """Hands the changes so far to the listener, oldest first."""
        if self.changes.codes:
            told, self.changes = self.changes, Changes()
            self.listener(told)


class Watch:
    """Notes the new status of a node; a status that it has just noted is no news.

    A completion is news again after a new run: when a parent that was RUNNING ends, what is below it is forgotten.
    So a condition polled at every tick is told once, and an action in a loop is told each time. `every` tells all
    completions: what Repeat repeats may be a function that completes at once, whose rounds no status tells apart.
    Where a node that completed at once is RUNNING when it is ticked again, that is a new run as well: before it is
    told, so are the statuses below it that are those of the run before; what this run has not reached is forgotten.
    """

    __slots__ = ("below", "every", "index", "last", "reached", "told", "told_by_leaf", "trace")

    def __init__(self, index: int, every: bool, below: list[Watch], trace: Trace) -> None:
        self.index = index
        self.every = every
        self.below = below
        self.trace = trace
        self.last = IDLE
        self.reached = self.told = 0  # the ticks in which it last had a status, and in which that was noted
        self.told_by_leaf = False  # so that a leaf needs no wrapper while it is RUNNING

    def change(self, status: int) -> None:
        """The node has this status now."""
        if status != RUNNING and (self.every or self.last == RUNNING):
            self._forget_below()
        elif status == RUNNING and self.last not in (IDLE, RUNNING):
            self._note_below()
        if status != self.last or (self.every and status != RUNNING):
            before = self.last
            self.last = status
            self.note(before)
            if before == RUNNING and not self.below:  # a leaf that took time
                self.trace.tell()

    def ended(self, status: int) -> int:
        """To be called by a leaf that tells by itself how it ended; returns the status."""
        if self.told_by_leaf:
            self.reached = self.trace.tick
            self.change(status)
        return status

    def note(self, before: int = IDLE) -> None:
        """Its status is news; `before` is what it was."""
        trace = self.trace
        self.told = trace.tick
        trace.changes.add(self.index, before, self.last, trace.shared.fault)

    def wrap(self, compiled: Compiled) -> Compiled:
        """The same node, watched. The root counts the ticks."""
        tick, halt = compiled
        leaf = as_function(tick)
        if leaf is not None and self.index and not self.every:
            return self._watched_function(leaf), self._watched_halt(halt)
        if self.told_by_leaf:
            return tick, self._watched_halt(halt)
        trace = self.trace

        def watched_tick() -> int:
            status = tick()
            self.reached = trace.tick
            if status is not self.last or self.every:
                self.change(status)
            return status

        def root_tick() -> int:
            trace.tick += 1
            trace.thread = get_ident()
            return watched_tick()

        return (watched_tick if self.index else root_tick), self._watched_halt(halt)

    def _watched_function(self, leaf: FunctionLeaf) -> Tick:
        """A wrapper around the function itself, which does what FunctionLeaf.tick does: the two calls become one."""

        # defaults and not cells, as in control.py: there are many of them
        def watched_tick(
            self: Watch = self, call: Call = leaf.call, trace: Trace = self.trace, after: tuple[int, ...] = _SUCCESS
        ) -> int:
            try:
                status = call()
            except KeyboardInterrupt:
                raise
            except BaseException as problem:
                status = unanswered(leaf.site, problem)
            else:
                if status is None:
                    status = SUCCESS
                elif status is not SUCCESS:
                    status = status_of(leaf.site, status)
            self.reached = now = trace.tick
            if status is not self.last:
                before, self.last = self.last, status
                if status is SUCCESS:
                    self.told = now
                    changes = trace.changes
                    changes.indices.append(self.index)
                    changes.codes.append(after[before])
                else:
                    self.note(before)
            return status

        return watched_tick

    def _watched_halt(self, halt: Halt) -> Halt:
        def watched_halt(keep: bool) -> None:
            halt(keep)
            if self.last == RUNNING:
                self.change(IDLE)

        return watched_halt

    def _forget_below(self) -> None:
        # a node whose last status is IDLE has nothing to forget below it
        stack = [child for child in self.below if child.last != IDLE]
        while stack:
            watch = stack.pop()
            watch.last = IDLE
            stack += [child for child in watch.below if child.last != IDLE]

    def _note_below(self) -> None:
        """Notes the completions of this tick that are not noted, children before parents, and forgets others."""
        now = self.trace.tick
        unnoted: list[Watch] = []
        stack = [child for child in self.below if child.last != IDLE]
        while stack:
            watch = stack.pop()
            if watch.last == RUNNING:  # it has just been noted, and with it what is below it
                continue
            if watch.reached != now:
                watch._forget_below()
                watch.last = IDLE
                continue
            if watch.told != now:
                unnoted.append(watch)
            stack += [child for child in watch.below if child.last != IDLE]
        for watch in reversed(unnoted):
            watch.note()

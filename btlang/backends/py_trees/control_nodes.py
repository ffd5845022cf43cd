"""Control nodes that ask again at every tick, that choose, or that do several things at once; see node.py."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence

from py_trees import common, composites

from btlang.backends.py_trees.node import FAILURE, RUNNING, SKIPPED, SUCCESS, UNKNOWN, Asking, Behaviour, Node, halt


class Reactive(Node):
    """A node that ticks from the first child each time; one that decides or is RUNNING halts those behind it."""

    passes = SUCCESS
    running, asked = -1, 0

    def __init__(self, name: str, children: Sequence[Behaviour], interrupts: list[Callable[[], None]]) -> None:
        self.interrupts = interrupts
        super().__init__(name, children, memory=False)

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        if not keep:
            self.running = -1

    def interrupt(self) -> None:
        if self.asked < self.running:
            child, self.running = self.running, -1
            halt(self.children[child])

    def run(self) -> Asking:
        if self.running > 0:
            self.interrupts.append(self.interrupt)
        skipped = 0
        status = self.passes
        for asked, child in enumerate(self.children):
            self.asked = asked
            status = yield from self.ask(child)
            if status == SKIPPED:
                halt(child)
                skipped += 1
            elif status != self.passes:
                break
        if self.interrupts and self.interrupts[-1] == self.interrupt:
            self.interrupts.pop()
        if status not in (self.passes, SKIPPED):
            if self.asked < self.running:
                halt(self.children[self.running])
            self.running = self.asked if status == RUNNING else -1
            return status
        self.running = -1
        return SKIPPED if skipped == len(self.children) else self.passes


class ReactiveSequence(Reactive, composites.Sequence):
    """A sequence that asks all again at every tick."""


class ReactiveFallback(Reactive, composites.Selector):
    """A selector that asks all again at every tick."""

    passes = FAILURE


class Parallel(Node, composites.Parallel):
    """A node that ticks all that haven't completed, until one decides. A negative count is counted from all."""

    def __init__(self, name: str, children: Sequence[Behaviour], successes: int = -1, failures: int = 1) -> None:
        self.successes, self.failures = successes, failures
        self.done: dict[int, common.Status] = {}
        super().__init__(name, children, policy=common.ParallelPolicy.SuccessOnAll(synchronise=False))

    def halt(self, keep: bool) -> None:
        for index, child in enumerate(self.children):
            if index not in self.done:
                halt(child, keep)
        if not keep:
            self.done = {}

    def complete(self, index: int, child: Behaviour) -> Generator[Behaviour, None, bool]:
        """Tick a child that hasn't completed; return whether it was skipped."""
        if index in self.done:
            return False
        status = yield from self.ask(child)
        if status not in (RUNNING, SKIPPED):
            self.done[index] = status
        return status == SKIPPED

    def run(self) -> Asking:
        count = len(self.children)
        required = self.successes + (count + 1 if self.successes < 0 else 0)
        allowed = self.failures + (count + 1 if self.failures < 0 else 0)
        skipped = 0
        for index, child in enumerate(self.children):
            skipped += yield from self.complete(index, child)
            successes = list(self.done.values()).count(SUCCESS)
            failures = len(self.done) - successes
            if successes >= required or (self.successes < 0 and successes + skipped >= required):
                self.halt(False)
                return SUCCESS
            if count - failures < required or failures == allowed:
                self.halt(False)
                return FAILURE
        return SKIPPED if skipped == count else RUNNING


class ParallelAll(Parallel):
    """A node that ticks all until each has completed; FAILURE if so many have failed."""

    def run(self) -> Asking:
        count = len(self.children)
        allowed = self.failures + (count + 1 if self.failures < 0 else 0)
        skipped = 0
        for index, child in enumerate(self.children):
            skipped += yield from self.complete(index, child)
        if skipped == count:
            return SKIPPED
        if skipped + len(self.done) < count:
            return RUNNING
        failures = list(self.done.values()).count(FAILURE)
        self.halt(False)
        return SUCCESS if failures < allowed else FAILURE


class IfThenElse(Node):
    """A node that asks the first child once, then ticks the second, or the third."""

    position = 0

    def halt(self, keep: bool) -> None:
        halt(self.children[self.position], keep)
        if not keep:
            self.position = 0

    def run(self) -> Asking:
        if self.position == 0:
            status = yield from self.answer(self.children[0])
            if status is UNKNOWN:
                return FAILURE
            if status == SUCCESS:
                self.position = 1
            elif status == FAILURE and len(self.children) == 3:
                self.position = 2
            elif status == SKIPPED:
                halt(self.children[0])
                return FAILURE
            else:
                return status
        chosen = self.children[self.position]
        status = yield from self.ask(chosen)
        if status != RUNNING:
            if status == SKIPPED:
                halt(chosen)
            self.position = 0
        return status


class WhileDoElse(Node):
    """A node that asks the first child each time and ticks the second, or the third; another answer halts the
    branch.
    """

    branch = 0

    def __init__(self, name: str, children: Sequence[Behaviour], interrupts: list[Callable[[], None]]) -> None:
        self.interrupts = interrupts
        super().__init__(name, children)

    def interrupt(self) -> None:
        child, self.branch = self.branch, 0
        halt(self.children[child])

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        if not keep:
            self.branch = 0

    def run(self) -> Asking:
        if self.branch:
            self.interrupts.append(self.interrupt)
        status = yield from self.answer(self.children[0])
        if self.interrupts and self.interrupts[-1] == self.interrupt:
            self.interrupts.pop()
        if status == RUNNING:
            return RUNNING
        chosen = 1 if status == SUCCESS else 2
        if self.branch and (self.branch != chosen or status in (SKIPPED, UNKNOWN)):
            self.interrupt()
        if status is UNKNOWN:
            return FAILURE
        if status == SKIPPED:
            halt(self.children[0])
            return FAILURE
        if chosen == len(self.children):
            return FAILURE
        status = yield from self.ask(self.children[chosen])
        if status == SKIPPED:
            halt(self.children[chosen])
        self.branch = chosen if status == RUNNING else 0
        return status


class Whenever(Node):
    """A rule with condition, reaction and work. The work is suspended while the reaction runs, once or each time."""

    armed, fired, reacting, running = True, False, False, 0

    def __init__(
        self, name: str, children: Sequence[Behaviour], once: bool, interrupts: list[Callable[[], None]]
    ) -> None:
        self.once, self.interrupts = once, interrupts
        super().__init__(name, children)

    def suspend(self) -> None:
        child, self.running = self.running, 0
        halt(self.children[child], keep=True)

    def end(self) -> None:
        self.armed, self.fired, self.reacting, self.running = True, False, False, 0
        halt(self.children[0])

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        if not keep:
            self.armed, self.fired, self.reacting, self.running = True, False, False, 0

    def run(self) -> Asking:
        condition, reaction, work = self.children
        if self.running:
            self.interrupts.append(self.suspend)
        status = yield from self.answer(condition)
        if self.interrupts and self.interrupts[-1] == self.suspend:
            self.interrupts.pop()
        if status == SKIPPED:
            halt(condition)
        if status != SUCCESS:
            self.armed = self.armed or not (self.fired or status == RUNNING or status is UNKNOWN)
        elif self.armed and not self.reacting:
            self.armed, self.fired, self.reacting = False, self.once, True
            if self.running:
                self.suspend()
        if self.reacting:
            status = yield from self.ask(reaction)
            if status == RUNNING:
                self.running = 1
                return RUNNING
            self.reacting = False
            if status == FAILURE:
                halt(work)
                self.end()
                return FAILURE
            if status == SKIPPED:
                halt(reaction)
        status = yield from self.ask(work)
        self.running = 2 if status == RUNNING else 0
        if not self.running:
            self.end()
            if status == SKIPPED:
                halt(work)
        return status

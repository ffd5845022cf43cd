"""Sequences and fallbacks, which tick one child after the other; see node.py."""

from __future__ import annotations

from collections.abc import Sequence

from py_trees import composites

from btlang.backends.py_trees.node import FAILURE, RUNNING, SKIPPED, SUCCESS, Asking, Behaviour, Node, halt


class InOrder(Node):
    """A node that ticks one child after the other at the status `passes`, from the one that was reached.

    One that `remembers` goes on with the child that failed or was stopped, and is RUNNING after each child that passed
    at once.
    """

    passes = SUCCESS
    remembers = False
    index = skipped = 0
    waiting = -1  # the child that was RUNNING at the last tick

    def halt(self, keep: bool) -> None:
        if self.index < len(self.children):
            halt(self.children[self.index], keep)
        if not keep:
            self.skipped, self.waiting = 0, -1
            if not self.remembers:
                self.index = 0

    def run(self) -> Asking:
        while self.index < len(self.children):
            status = yield from self.ask(self.children[self.index])
            waited, self.waiting = self.waiting == self.index, -1
            if status == RUNNING:
                self.waiting = self.index
                return RUNNING
            if status == SKIPPED:
                halt(self.children[self.index])
                self.skipped += 1
            elif status != self.passes:
                self.skipped = 0
                if not self.remembers:
                    self.index = 0
                return status
            self.index += 1
            at_once = status == self.passes and not waited
            if self.remembers and at_once and self.index < len(self.children):
                return RUNNING
        skipped, self.skipped, self.index = self.skipped, 0, 0
        return SKIPPED if skipped == len(self.children) else self.passes


class SkippableSequence(InOrder, composites.Sequence):
    """The Sequence of the engine."""

    def __init__(self, name: str, children: Sequence[Behaviour]) -> None:
        super().__init__(name, children, memory=True)


class SkippableFallback(InOrder, composites.Selector):
    """The Fallback of the engine."""

    passes = FAILURE

    def __init__(self, name: str, children: Sequence[Behaviour]) -> None:
        super().__init__(name, children, memory=True)


class SequenceWithMemory(SkippableSequence):
    """The SequenceWithMemory of the engine."""

    remembers = True


class TryCatch(InOrder):
    """A sequence of all but the last child; when it fails, the last one runs to its end: FAILURE."""

    catching = False

    def halt(self, keep: bool) -> None:
        halt(self.children[-1 if self.catching else self.index], keep)
        if not keep:
            self.index, self.skipped, self.catching = 0, 0, False

    def run(self) -> Asking:
        last = len(self.children) - 1
        while not self.catching:
            status = yield from self.ask(self.children[self.index])
            if status == RUNNING:
                return RUNNING
            if status == FAILURE:
                self.catching = True
                break
            if status == SKIPPED:
                halt(self.children[self.index])
                self.skipped += 1
            self.index += 1
            if self.index == last:
                skipped, self.index, self.skipped = self.skipped, 0, 0
                return SKIPPED if skipped == last else SUCCESS
        status = yield from self.ask(self.children[last])
        if status == RUNNING:
            return RUNNING
        if status == SKIPPED:
            halt(self.children[last])
        self.index, self.skipped, self.catching = 0, 0, False
        return FAILURE


class PipelineSequence(Node):
    """A node that ticks all children up to the furthest one reached, again those that have completed."""

    reached = 0

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        if not keep:
            self.reached = 0

    def run(self) -> Asking:
        skipped = 0
        for index, child in enumerate(self.children):
            status = yield from self.ask(child)
            if status == RUNNING:
                if index >= self.reached:
                    self.reached = index
                    return RUNNING
            elif status == FAILURE:
                self.halt(False)
                return FAILURE
            elif status == SKIPPED:
                skipped += 1
        self.halt(False)
        return SKIPPED if skipped == len(self.children) else SUCCESS


class RecoveryNode(Node):
    """A node whose second child recovers when the first fails, which is then tried again, at most so many times."""

    position = count = 0

    def __init__(self, name: str, children: Sequence[Behaviour], retries: int = 1) -> None:
        self.retries = retries
        super().__init__(name, children)

    def halt(self, keep: bool) -> None:
        halt(self.children[self.position], keep)
        if not keep:
            self.position = self.count = 0

    def run(self) -> Asking:
        while True:
            child = self.children[self.position]
            status = yield from self.ask(child)
            if status == RUNNING:
                return RUNNING
            if self.position == 0 and status == FAILURE and self.count < self.retries:
                self.position = 1
            elif self.position == 1 and status == SUCCESS:
                self.position = 0
                self.count += 1
            else:
                if status == SKIPPED:
                    halt(child)
                position, self.position, self.count = self.position, 0, 0
                return FAILURE if position == 1 else status


class RoundRobin(Node):
    """A node that runs one child after the other until one succeeds; the next run begins after that one."""

    position = failed = 0
    runs = False

    def halt(self, keep: bool) -> None:
        halt(self.children[self.position], keep)
        if self.runs and not keep:
            self.position, self.failed, self.runs = 0, 0, False

    def run(self) -> Asking:
        self.runs, skipped = True, 0
        while self.failed + skipped < len(self.children):
            child = self.children[self.position]
            status = yield from self.ask(child)
            if status == RUNNING:
                return RUNNING
            if status == SKIPPED:
                halt(child)
                skipped += 1
            self.position = (self.position + 1) % len(self.children)
            if status == SUCCESS:
                self.failed, self.runs = 0, False
                return SUCCESS
            if status == FAILURE:
                self.failed += 1
        self.position, self.failed, self.runs = 0, 0, False
        return SKIPPED if skipped == len(self.children) else FAILURE

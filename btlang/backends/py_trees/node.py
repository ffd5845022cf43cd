"""The base of nodes that py_trees doesn't have, or that do something else there.

They do what the nodes of btlang's engine do (docs/engine.md). Where one is SKIPPED there, its status here is INVALID.
So only these nodes, and none of py_trees, may stand around one that can be skipped. `btc compile --to py_trees` copies
the text of a class, and of what it uses, into its module: nothing here needs btlang.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Generator, Iterator, Sequence
from typing import Any

from py_trees import behaviour, common, composites

Behaviour = behaviour.Behaviour
Asking = Generator[Behaviour, None, common.Status]
Answering = Generator[Behaviour, None, common.Status | None]
UNKNOWN = None
RUNNING, SUCCESS, FAILURE = common.Status.RUNNING, common.Status.SUCCESS, common.Status.FAILURE
SKIPPED = common.Status.INVALID


def halt(child: Behaviour, keep: bool = False) -> None:
    """Stop what runs in a node, and reset it; one of ours can keep positions, counts and times for its next tick."""
    if isinstance(child, Node):
        child.halt(keep)
        child.status = common.Status.INVALID
    elif child.status != common.Status.INVALID:
        child.stop(common.Status.INVALID)


class Node(composites.Composite):
    """A node of ours: `run` is a tick that returns a status, `halt` is as in the engine."""

    def __init__(self, name: str, children: Sequence[Behaviour] = (), **more: Any) -> None:
        super().__init__(name, children=list(children), **more)

    @abstractmethod
    def run(self) -> Asking:
        """Tick once; yield the nodes that are ticked below."""

    def halt(self, keep: bool) -> None:
        """Stop what runs below; reset if nothing is kept."""
        for child in self.children:
            halt(child, keep)

    def ask(self, child: Behaviour) -> Asking:
        """Tick a child and return its status."""
        self.current_child = child
        yield from child.tick()
        return child.status

    def answer(self, child: Behaviour) -> Answering:
        """Tick a child and return its status, or UNKNOWN for a FAILURE if a leaf below it couldn't know its answer.

        Such a leaf says so by an attribute `known` that is False.
        """
        known = True
        self.current_child = child
        for node in child.tick():
            known = known and getattr(node, "known", True)
            yield node
        return UNKNOWN if child.status == FAILURE and not known else child.status

    def tick(self) -> Iterator[Behaviour]:
        """Tick as py_trees does."""
        if self.status != RUNNING:
            self.initialise()
        status = yield from self.run()
        if status != RUNNING:
            self.terminate(status)
        self.status = status
        yield self

    def stop(self, new_status: common.Status = common.Status.INVALID) -> None:
        """Halt if py_trees stops it from outside."""
        if new_status == common.Status.INVALID:
            self.halt(False)
        self.terminate(new_status)
        self.status = new_status
        self.iterator = self.tick()


def interrupting(leaf: Behaviour, interrupts: list[Callable[[], None]]) -> Behaviour:
    """Wrap an action that stands before others in a reactive node: before it starts, those that it replaces are
    stopped.
    """
    begin: Callable[[], None] = leaf.initialise

    def initialise() -> None:
        while interrupts:
            interrupts.pop()()
        begin()

    leaf.initialise = initialise  # type: ignore[method-assign]
    return leaf


class Skipped(Behaviour):
    """A leaf that is always skipped."""

    def update(self) -> common.Status:
        return SKIPPED

"""Completions that are compared together give the same changes as each node that records its own at once.

So do all who follow them: the statuses of a run, its snapshots, and what failed in it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

from hypothesis import example, given
from hypothesis import strategies as st

from btlang.engine import generation
from btlang.engine.changes import Changes
from btlang.engine.engine import Engine
from btlang.engine.fused import choose_compiler
from btlang.engine.leaves.callables import FunctionLeaf
from btlang.engine.nodes.control import parallel
from btlang.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from btlang.engine.status_trace import NodeTrace
from btlang.run.events import StatusesChanged
from btlang.run.failure_history import FailureHistory
from btlang.run.follower import RunFollower
from btlang.run.snapshot import RunState, Shape
from btlang.tree.node import Node, Tree
from tests.profiles import searches

from .conftest import NEVER, SIZES, USUAL, limited
from .random_trees import BUSY, TREES, Drawn, letters
from .scripted import World, n


class Watched:
    """An engine, the changes that it has reported, and who follows them."""

    def __init__(self, shape: Node, ticks_before: int) -> None:
        self.ticks_before = ticks_before
        self.world = World()
        self.drawn = Drawn(shape)
        self.drawn.bind(self.world)
        self.changes: list[tuple[int, int, int, str]] = []
        self.saved: list[str] = []
        self.begin()

    def begin(self) -> None:
        """Begin a run."""
        with patch.object(generation, "TICKS_BEFORE", self.ticks_before):
            self.engine = Engine(
                self.drawn.tree,
                self.world.bindings.get,
                clock=self.world.clock,
                services={"robot": self.world.robot},
                listener=self._take,
            )
        engine = self.engine
        self.nodes = [node for _, node in engine.nodes]
        self.state = RunState(Shape([engine.parent(index) for index in range(engine.size)]), self.nodes)
        self.history, self.follower = FailureHistory(engine), RunFollower(engine)

    def obey(self, order: str) -> None:
        """Tick, halt, suspend, or go on in a new engine."""
        engine = self.engine
        if order in "he":
            engine.halt(emergency=order == "e")
        elif order in "pr":
            self.saved.append(json.dumps(engine.save()["nodes"]))
            saved = engine.save()
            engine.suspend()
            if order == "r":
                self.begin()
                self.engine.restore(saved)
        else:
            engine.tick()
        self.world.clock.advance(60 if order == "m" else 1)

    def _take(self, changes: Changes) -> None:
        event = StatusesChanged(self.world.clock.now, "", 0, 0.0, changes, self.engine)
        assert event.count == len(list(changes))
        self.changes += event.without_paths()
        for sink in (self.state.take, self.history, self.follower):
            sink(event)


def one_by_one(self: NodeTrace, tick: Callable[[], int]) -> Callable[[], int]:
    """In place of NodeTrace._trace_tick."""

    def traced_tick() -> int:
        status = tick()
        self.change(status)
        return status

    return traced_tick


def function_by_itself(self: NodeTrace, leaf: FunctionLeaf, measured: Callable[[], str] | None) -> Callable[[], int]:
    """In place of NodeTrace._trace_function."""
    return one_by_one(self, leaf.tick)


def plain_but_parallel(usual: Any, *others: Any) -> Any:
    """In place of choose_compiler. A Parallel with its default thresholds saves other things in its variant."""
    return choose_compiler(usual, *others) if usual is parallel else usual


@contextmanager
def singly() -> Iterator[None]:
    """Have each node record its own changes at once."""
    with (
        patch("btlang.engine.compile.choose_compiler", plain_but_parallel),
        patch.object(NodeTrace, "_trace_tick", one_by_one),
        patch.object(NodeTrace, "_trace_function", function_by_itself),
    ):
        yield


FUNCTIONS = n("ReactiveSequence", Node("F:rs"), Node("F:r"))
"""The first one halts the second one and nothing else."""


@example(FUNCTIONS, "ttt", 0, USUAL)
@searches(150, 20000)
@given(TREES | BUSY, letters("tttttthperm", 3, 12), st.sampled_from((NEVER, 0, 2)), SIZES)
def test_changes_together_are_those_one_by_one(
    shape: Node, orders: str, ticks_before: int, sizes: dict[str, int]
) -> None:
    with limited(sizes):
        together = Watched(shape, ticks_before)
    with singly():
        alone = Watched(shape, NEVER)
    for order in orders:
        with limited(sizes):
            together.obey(order)
        with singly():
            alone.obey(order)
        assert together.changes == alone.changes
        assert together.saved == alone.saved or ticks_before != NEVER  # which saves nothing that never changes
        assert together.follower.codes() in (bytes(alone.state.statuses), b"")
        assert together.history.tried == alone.history.tried
        snapshot = together.follower.snapshot(lambda node: node.id)
        reached = {together.engine.path(at): code for at, code in enumerate(together.follower.codes()) if code < IDLE}
        assert snapshot.statuses == reached


def test_what_completes_within_a_tick_is_one_entry_whatever_its_size() -> None:
    told: list[Changes] = []
    world = World()
    acts = [world.fn("A", "s"), n("Inverter", world.fn("B", "f")), n("Fallback", world.fn("C", "f"), Node("A"))] * 50
    root = n("Repeat", n("Sequence", *acts), num_cycles=-1)
    engine = Engine(Tree(root), world.bindings.get, clock=world.clock, listener=told.append)
    for _ in range(3):
        engine.tick()
    assert [len(changes.entries) for changes in told] == [3, 2, 2]  # and the Sequence, and at first the Repeat
    assert [len(changes) for changes in told] == [302, 301, 301]


def test_changes_of_some_nodes() -> None:
    told: list[Changes] = []
    world = World()
    root = n("Sequence", world.fn("A", "s"), n("Inverter", world.fn("B", "f")), world.cls("C", "rs"))
    engine = Engine(Tree(root), world.bindings.get, clock=world.clock, listener=told.append)
    engine.tick()
    engine.tick()
    found = [list(changes.of({1, 3, 4})) for changes in told]
    assert [each for each in found if each] == [[(1, SUCCESS), (3, FAILURE), (4, RUNNING)], [(4, SUCCESS)]]

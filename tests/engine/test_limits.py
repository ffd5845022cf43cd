"""What the engine promises for deep trees, long missions and several threads."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from copy import copy, deepcopy

import pytest

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.tree.dump import outline, plain
from btlang.tree.node import Node, Tree
from tests.profiles import amount, cases

from .scripted import World, n

# Trees may be 10,000 deep

DEPTH = 10_000


def chain(leaf: Node, id: str, depth: int = DEPTH, **ports: str) -> Node:
    for _ in range(depth):
        leaf = n(id, leaf, **ports)
    return leaf


def test_a_deep_tree_is_built_compared_copied_and_printed() -> None:
    ports = {"num_cycles": "{n}", "_while": "true"}
    tree, same = (Tree(chain(Node("A"), "Repeat", **ports)) for _ in range(2))
    other = Tree(chain(Node("B"), "Repeat", **ports))
    assert tree == same
    assert tree != other
    assert hash(tree) == hash(same) != hash(other)
    assert sum(1 for _ in tree.walk()) == DEPTH + 1
    assert plain(tree).count("\n") == DEPTH
    assert deepcopy(tree) == copy(tree) == tree
    assert repr(tree) == "Tree(root=..., subtrees=(), name='', models=(), origin=None, warnings=())"


def test_a_deep_tree_is_drawn() -> None:
    tree = Tree(chain(Node("A"), "Inverter", 3000))  # with 10,000 levels the indentation alone takes 400 MB
    assert outline(tree).count("\n") == 3000


@pytest.mark.parametrize("watched", [False, True])
@cases(
    ("id", "ports"),
    [
        ("ForceSuccess", {}),
        ("Sequence", {}),
        ("ReactiveSequence", {}),
        ("SubTree", {}),
        ("Repeat", {"num_cycles": "{n}", "_while": "true", "_onHalted": "n += 0", "_post": "n += 0"}),
    ],
    usual=3,
)
def test_a_deep_tree_runs(id: str, ports: dict[str, str], watched: bool) -> None:
    depth = amount(2_000, DEPTH) if ports else DEPTH  # seconds, of a level with conditions
    world = World()
    leaf = world.cls("A", "r" * 5 + "s")
    if id == "SubTree":
        names = [f"t{level}" for level in range(depth)]
        uses = [n("SubTree", ID=name, _autoremap="true") for name in names] + [leaf]
        tree = Tree(uses[0], tuple(zip(names, uses[1:], strict=True)))
    else:
        tree = Tree(chain(leaf, id, depth, **ports))
    engine = world.engine(tree, watched)
    engine.blackboard.set("n", 1)
    assert engine.tick() == RUNNING
    engine.suspend()
    assert engine.tick() == RUNNING
    engine.halt()
    assert world.ticks(engine, 4) == "rrrs"
    assert world.log == ["A.start", "A.halt", "A.start", "A.halt", "A.start", "A.tick", "A.tick", "A.tick"]
    assert engine.path(depth) == "/0" * depth
    if watched:
        assert sum(status == SUCCESS for _, status in world.changes) == depth + 1


def test_a_deep_branch_halts_another_one_that_is_as_deep() -> None:
    ports = {"num_cycles": "{n}", "_while": "true"}
    world = World()
    alarm = n("Sequence", world.fn("C", "fs"), chain(world.cls("A", "r"), "Repeat", **ports))
    work = chain(world.cls("B", "r"), "Repeat", **ports)
    engine = world.engine(n("ReactiveFallback", alarm, work), watched=True)
    engine.blackboard.set("n", 2)
    assert world.ticks(engine, 2) == "rr"
    assert world.log == ["C", "B.start", "C", "B.halt", "A.start"]


def test_python_recurses_no_deeper_than_before_when_a_deep_tree_is_not_ticked() -> None:
    """Where it may, JSON that is nested too deep crashes the process instead of raising an error."""
    usual, seen = sys.getrecursionlimit(), []

    def leaf() -> None:
        seen.append(sys.getrecursionlimit())
        if len(seen) == 1:
            assert other.tick() == SUCCESS
            seen.append(sys.getrecursionlimit())

    other = Engine(Tree(chain(n("B"), "Inverter", 4000)), lambda id: LeafBinding(lambda: None), clock=Clock())
    engine = Engine(Tree(chain(n("A"), "Inverter", 3000)), lambda id: LeafBinding(leaf), clock=Clock())
    assert engine.tick() == SUCCESS
    engine.halt()
    assert min(seen) > 3000
    assert sys.getrecursionlimit() == usual


# However many ticks there are, they leak no memory


@pytest.mark.long
def test_ticks_take_no_memory() -> None:
    """With leaves of all kinds, of which some fail and some are halted again and again."""

    class Leaf:
        def start(self, to: Callable[[int], None]) -> None:
            to(1)

        def tick(self) -> None: ...

        def halt(self) -> None: ...

    def steps() -> Iterator[None]:
        while True:
            yield

    world = World()
    world.bind("Function", lambda: False)
    world.bind("Class", Leaf, outputs=("to",))
    world.bind("Generator", steps)
    work = n("Parallel", n("Class", to="{made}"), n("Generator"), n("Sleep", msec=50))
    root = n("Timeout", n("Fallback", n("Function"), n("Script", code="gone == 1"), work), msec=3)
    engine = world.engine(root)
    for count in (10_000, amount(250_000, 1_000_000)):
        before = sys.getallocatedblocks()
        for _ in range(count):
            engine.tick()
            world.clock.now += 0.001
        grown = sys.getallocatedblocks() - before
    assert engine.failure is None or engine.failure.reason == "took longer than 0.003 s"
    assert grown < 100


# One thread at a time


@pytest.mark.parametrize("inside", ["start", "halt"])
@pytest.mark.parametrize("order", ["tick", "halt", "suspend"])
def test_another_thread_is_refused_while_a_leaf_is_called(order: str, inside: str) -> None:
    world = World()
    entered, go_on = threading.Event(), threading.Event()

    class Slow:
        def start(self) -> None:
            self.wait("start")

        def tick(self) -> None: ...

        def halt(self) -> None:
            self.wait("halt")

        def wait(self, where: str) -> None:
            world.log.append(where)
            if where == inside:
                entered.set()
                assert go_on.wait(60)

    engine = world.engine(world.bind("A", Slow))

    def use() -> None:
        engine.tick()
        engine.halt()

    thread = threading.Thread(target=use)
    thread.start()
    assert entered.wait(60)
    with pytest.raises(RuntimeError, match="neither a leaf nor another thread may tick or halt it now"):
        getattr(engine, order)()
    go_on.set()
    thread.join(60)
    assert world.since() == ["start", "halt"]
    assert engine.tick() == RUNNING
    engine.halt()
    assert world.since() == ["start", "halt"]


def test_threads_that_tick_at_the_same_moment_are_never_both_let_in() -> None:
    inside, most, refused = 0, 0, [0, 0]

    def call() -> None:
        nonlocal inside, most
        inside += 1
        most = max(most, inside)
        inside -= 1

    world = World()
    engine = world.engine(world.bind("A", call))
    begin = threading.Barrier(2, timeout=60)

    def tick(which: int) -> None:
        begin.wait()
        end = time.monotonic() + 50
        ticks = 0
        while ticks < 20_000 or (sum(refused) == 0 and time.monotonic() < end):  # a busy machine may switch rarely
            ticks += 1
            try:
                engine.tick()
            except RuntimeError:
                refused[which] += 1

    threads = [threading.Thread(target=tick, args=[which]) for which in (0, 1)]
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
    finally:
        sys.setswitchinterval(interval)
    assert most == 1
    assert sum(refused) > 0
    assert engine.tick() == SUCCESS


def test_a_tree_refuses_to_be_ticked_from_within() -> None:
    world = World()
    engines: list[Engine] = []
    engine = world.engine(world.bind("A", lambda: engines[0].tick()))
    engines.append(engine)
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert "the tree is being ticked" in engine.failure.reason
    assert engine.tick() == FAILURE


def test_changes_are_not_told_in_another_thread_than_that_of_the_tick() -> None:
    told: list[list[int]] = []
    engines: list[Engine] = []

    def call() -> None:
        thread = threading.Thread(target=engines[0].flush)
        thread.start()
        thread.join(60)
        assert told == []

    bindings = {"A": LeafBinding(lambda: True), "B": LeafBinding(call)}
    root = n("Sequence", n("A"), n("B"))
    engines.append(Engine(Tree(root), bindings.get, clock=Clock(), listener=lambda c: told.append([i for i, *_ in c])))
    assert engines[0].tick() == SUCCESS
    assert told == [[1, 2, 0]]

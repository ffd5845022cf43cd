"""What the engine promises whatever the tree is, one section for each promise; test_limits.py has the rest of them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from itertools import product

import pytest
from hypothesis import given

from btlang.engine.engine import Engine
from btlang.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node
from tests.profiles import each_of, searches

from .checked import CheckedWorld
from .every_type import RUNS, around, running
from .random_trees import BUSY, TREES, Drawn, letters
from .scripted import World, broken, leaves, n

every_type = pytest.mark.parametrize("id", RUNS)


def test_every_node_type_is_here() -> None:
    assert set(RUNS) == {id for id, kind in CATALOGUE.items() if kind.most} | {"SubTree"}


# A halt reaches every running leaf exactly once, children before parents


def told_in_order(engine: Engine, before: dict[int, int], changes: list[tuple[int, int]]) -> None:
    """Each node that was RUNNING became IDLE once, after all those below it."""
    idle = [index for index, status in changes if status == IDLE and before.get(index) == RUNNING]
    assert sorted(idle) == sorted(index for index, status in before.items() if status == RUNNING)
    paths = [engine.path(index).rstrip("/") + "/" for index in idle]
    for at, path in enumerate(paths):
        assert not any(below.startswith(path) for below in paths[at + 1 :])


@each_of([*product(RUNS, ("halt", "suspend"))], at_a_time=25)
def test_a_halt_reaches_every_running_leaf_once(id: str, order: str) -> None:
    world, engine, run = running(id)
    before = dict(world.changes)
    assert sum(status == RUNNING for status in before.values()) >= len(run) + 2
    world.changes.clear()
    getattr(engine, order)()
    assert world.log == [f"{name}.halt" for name in run]
    told_in_order(engine, before, world.changes)
    engine.suspend()
    engine.halt()
    assert world.log == [f"{name}.halt" for name in run]
    assert engine.status == IDLE


@every_type
def test_what_was_halted_starts_anew(id: str) -> None:
    for order in ("halt", "suspend"):
        world, engine, run = running(id)
        getattr(engine, order)()
        engine.blackboard.set("x", 2)
        world.since()
        assert engine.tick() == RUNNING
        assert [call for call in world.log if call[1:]] == [f"{name}.start" for name in run]


def test_a_halt_stops_nothing_that_does_not_run() -> None:
    world = World()
    engine = world.engine(n("Sequence", world.cls("A", "rs"), world.gen("B", "s"), world.cls("C", "f")))
    engine.halt()
    assert world.ticks(engine, 2) == "rf"
    engine.halt()
    assert world.log == ["A.start", "A.tick", "B.start", "C.start"]


# On random trees, where leaves raise exceptions and interrupts wherever they are called


@searches(100, 15000)
@given(BUSY | TREES, letters("ttttthpe", 3, 10), letters("................xi", 1, 12))
def test_leaves_are_used_as_they_must_be(shape: Node, orders: str, trouble: str) -> None:
    """Started before they are ticked, halted once and only while they run, none next to what excludes it.

    No exception but an interrupt comes out, and nothing runs after that, or after a halt or a suspension.
    """
    world = CheckedWorld(Drawn(shape), trouble)
    engine = world.checked
    status: dict[int, int] = {}
    for order in orders:
        world.changes.clear()
        run, world.halts = len(world.live), 0
        interrupted = False
        try:
            {"t": engine.tick, "h": engine.halt, "p": engine.suspend, "e": lambda: engine.halt(emergency=True)}[order]()
        except KeyboardInterrupt:
            interrupted = True
        assert world.problems == []
        if order in "pe":
            assert world.halts == run
        if order != "t" or interrupted:
            assert world.live == []
        if order in "pe" and not interrupted:
            told_in_order(engine, status, world.changes)
        status.update(world.changes)
        world.note_successes()
        world.clock.advance(1)
    assert world.problems == []
    world.calm()


def test_a_closed_generator_is_not_resumed() -> None:
    for order in ("halt", "suspend"):
        world = World()
        engine = world.engine(world.gen("A", "rs"))
        engine.tick()
        getattr(engine, order)()
        assert engine.tick() == SUCCESS
        assert world.log == ["A.start", "A.halt", "A.start"]


# The reactive rule: a running child is halted before a generator or class leaf starts under another one


def test_a_running_child_is_halted_before_another_action_starts() -> None:
    for start in (World.cls, World.gen):
        world = World()
        first = n("Sequence", world.fn("C", "fs"), start(world, "A", "r"))
        engine = world.engine(n("ReactiveFallback", first, world.cls("B", "r")))
        world.ticks(engine, 2)
        assert world.log == ["C", "B.start", "C", "B.halt", "A.start"]


def test_functions_halt_nothing() -> None:
    world = World()
    engine = world.engine(
        n("ReactiveSequence", n("Sequence", world.fn("C", "s"), world.fn("D", "s")), world.cls("B", "r"))
    )
    world.ticks(engine, 3)
    assert world.log == ["C", "D", "B.start", "C", "D", "B.tick", "C", "D", "B.tick"]


def test_an_action_that_ends_at_once_also_interrupts() -> None:
    world = World()
    engine = world.engine(n("ReactiveSequence", world.cls("A", "s"), world.cls("B", "r")))
    world.ticks(engine, 2)
    assert world.log == ["A.start", "B.start", "B.halt", "A.start", "B.start"]


def test_nested_reactive_nodes_halt_the_inner_one_first() -> None:
    world = World()
    alarm = n("Sequence", world.fn("C", "fs"), world.cls("A", "r"))
    inner = n("ReactiveFallback", n("Sequence", world.fn("D", "fs"), world.cls("E", "r")), world.cls("B", "r"))
    engine = world.engine(n("ReactiveFallback", alarm, n("Parallel", inner, world.cls("X", "r"))))
    world.ticks(engine, 1)
    world.since()
    world.ticks(engine, 1)
    assert world.log == ["C", "B.halt", "X.halt", "A.start"]


def test_parallel_branches_do_not_interrupt_each_other() -> None:
    world = World()
    left = n("ReactiveFallback", n("Sequence", world.fn("C", "fs"), world.cls("A", "r")), world.cls("B", "r"))
    right = n("ReactiveSequence", world.fn("D", "s"), world.cls("E", "r"))
    engine = world.engine(n("Parallel", right, left))
    world.ticks(engine, 2)
    assert world.log == ["D", "E.start", "C", "B.start", "D", "E.tick", "C", "B.halt", "A.start"]


def test_an_action_as_condition_interrupts_what_depends_on_it() -> None:
    world = World()
    engine = world.engine(n("WhileDoElse", world.gen("C", "s"), world.cls("A", "r"), n("AlwaysSuccess")))
    world.ticks(engine, 2)
    assert world.log == ["C.start", "A.start", "A.halt", "C.start", "A.start"]


# Exceptions in tick, start and halt never escape, and never skip the halt of another leaf


def in_start(world: World) -> Node:
    return broken(world, "X", "start", ValueError("trouble"))


def in_tick(world: World) -> Node:
    return broken(world, "X", "tick", ValueError("trouble"))


def in_function(world: World) -> Node:
    return world.fn("X", "x")


def in_generator(world: World) -> Node:
    return world.gen("X", "rx")


def exits_in_tick(world: World) -> Node:
    return broken(world, "X", "tick", SystemExit(3))


def exits(world: World) -> Node:
    return world.bind("X", lambda: sys.exit(3))


def engine_with(leaf: Callable[[World], Node], world: World, id: str, **options: bool) -> Engine:
    """Over a node of this type, with such a leaf in each place where its row of RUNS has an `R`."""
    world.cls("Z", "r")
    scripts = RUNS[id][0].split()
    others = leaves(world, scripts)
    children = [leaf(world) if script == "R" else other for script, other in zip(scripts, others, strict=True)]
    engine = world.engine(around(id, *children), **options)
    engine.blackboard.set("x", 1)
    engine.blackboard.set("at", 0)
    return engine


@each_of([*product(RUNS, (in_start, in_tick, in_function, in_generator, exits_in_tick, exits))], at_a_time=60)
def test_an_exception_in_a_leaf_is_its_failure(id: str, leaf: Callable[[World], Node]) -> None:
    world = World()
    engine = engine_with(leaf, world, id, watched=True)
    for _ in range(3):
        engine.tick()
    assert {(at, FAILURE) for at, (_, node) in enumerate(engine.nodes) if node.id == "X"} & set(world.changes)
    engine.halt()
    starts, halts = world.log.count("Z.start"), world.log.count("Z.halt")
    assert starts == halts > 0
    assert world.log.count("start") == world.log.count("halt")
    assert engine.take_halt_failures() == []


@every_type
def test_an_exit_stays_within_the_tree_also_where_nobody_watches(id: str) -> None:
    """Functions are then called by the node above them itself."""
    world = World()
    engine = engine_with(exits, world, id)
    for _ in range(3):
        engine.tick()


@each_of([*product(RUNS, ("halt", "suspend"))], at_a_time=25)
def test_an_exception_in_halt_keeps_no_other_leaf_from_halting(id: str, order: str) -> None:
    def stubborn() -> Iterator[None]:
        try:
            yield
            yield
        finally:
            world.log.append("halt")
            raise ValueError("stuck")

    def stuck(world: World) -> Node:
        return broken(world, "X", "halt", ValueError("stuck"))

    def leaving(world: World) -> Node:
        return broken(world, "X", "halt", SystemExit("stuck"))

    for bad, kind in (
        (stuck, "ValueError"),
        (lambda world: world.bind("X", stubborn), "ValueError"),
        (leaving, "SystemExit"),
    ):
        world = World()
        engine = engine_with(bad, world, id)
        engine.tick()
        getattr(engine, order)()
        count = RUNS[id][0].split().count("R")
        assert [call for call in world.log if call.endswith("halt")] == ["halt"] * count + ["Z.halt"]
        assert [failure.reason for failure in engine.take_halt_failures()] == [f"{kind}: stuck"] * count
        assert engine.take_halt_failures() == []


def test_a_generator_that_goes_on_when_it_is_closed() -> None:
    def stubborn() -> Iterator[None]:
        try:
            yield
        except GeneratorExit:
            yield

    world = World()
    engine = world.engine(n("Parallel", world.bind("G", stubborn), world.cls("B", "r")))
    engine.tick()
    engine.halt()
    assert world.log == ["B.start", "B.halt"]
    [failure] = engine.take_halt_failures()
    assert (failure.path, failure.reason) == ("/0", "RuntimeError: generator ignored GeneratorExit")


def test_failures_of_halts_that_nobody_asks_for_do_not_pile_up() -> None:
    world = World()
    engine = world.engine(broken(world, "X", "halt", ValueError("stuck")))
    for _ in range(1200):
        engine.tick()
        engine.halt()
    assert len(engine.take_halt_failures()) == 1000


@pytest.mark.parametrize("where", ["start", "tick"])
def test_an_interrupt_halts_everything_and_comes_through(where: str) -> None:
    world = World()
    tree = n(
        "ReactiveSequence",
        world.fn("C", "s"),
        n("Parallel", world.cls("B", "r"), broken(world, "A", where, KeyboardInterrupt())),
    )
    engine = world.engine(tree)
    if where == "tick":
        engine.tick()
    world.since()
    with pytest.raises(KeyboardInterrupt):
        engine.tick()
    assert [entry for entry in world.log if entry.endswith("halt")] == ["B.halt", "halt"]
    engine.halt()
    assert world.log.count("B.halt") == 1


def test_an_interrupt_in_halt_still_halts_the_others() -> None:
    world = World()
    engine = world.engine(n("Parallel", broken(world, "A", "halt", KeyboardInterrupt()), world.cls("B", "r")))
    engine.tick()
    with pytest.raises(KeyboardInterrupt):
        engine.halt()
    assert world.log == ["start", "B.start", "halt", "B.halt"]

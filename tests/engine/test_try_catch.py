"""What a halted TryCatch with catch_on_halt starts, and when it does not. The tables in docs/engine.md have more."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.status import FAILURE, RUNNING
from btlang.tree.node import Node

from .scripted import World, broken, n


def tried(work: Node, last: Node) -> Node:
    return n("TryCatch", work, last, catch_on_halt="true")


def test_a_generator_that_cleans_up_goes_to_its_first_yield_and_is_closed() -> None:
    def clean() -> Iterator[None]:
        world.log.append("cleaning")
        try:
            yield
            world.log.append("too late")
        finally:
            world.log.append("closed")

    world = World()
    engine = world.engine(tried(world.cls("A", "r"), world.bind("B", clean)))
    engine.tick()
    engine.halt()
    assert world.log == ["A.start", "A.halt", "cleaning", "closed"]


def test_its_replacement_starts_when_all_is_cleaned_up() -> None:
    world = World()
    alarm = n("Sequence", world.fn("C", "fs"), world.cls("A", "r"))
    engine = world.engine(n("ReactiveFallback", alarm, tried(world.cls("B", "r"), world.gen("D", "r"))))
    world.ticks(engine, 3)
    assert world.log == ["C", "B.start", "C", "B.halt", "D.start", "D.halt", "A.start", "A.tick"]


@pytest.mark.parametrize("order", ["halt", "tick"])
@pytest.mark.parametrize("id", ["WhileDoElse", "Whenever"])
def test_work_is_halted_before_its_condition_is_cleaned_up(id: str, order: str) -> None:
    """A condition that is RUNNING leaves the work of these two nodes alone, so that both run."""
    world = World()
    waiting = n("Timeout", tried(world.fn("F", "r"), world.cls("B", "s")), msec=1000)
    if id == "WhileDoElse":
        root = n(id, n("Fallback", world.fn("C", "sf"), waiting), world.cls("A", "r"))
    else:
        root = n(id, waiting, n("AlwaysSuccess"), world.cls("A", "r"))
    engine = world.engine(root)
    world.ticks(engine, 2)
    world.clock.advance(1)
    world.since()
    getattr(engine, order)()
    assert [call for call in world.since() if call[0] in "AB"][:2] == ["A.halt", "B.start"]


def test_what_fails_while_it_cleans_up_is_told_and_changes_nothing() -> None:
    def lost() -> None:
        raise ActionFailed("no cloth")

    world = World()
    work = n("Timeout", tried(world.cls("A", "r"), world.bind("B", lost)), msec=1000)
    engine = world.engine(n("Parallel", work, world.cls("C", "r")))
    engine.tick()
    world.clock.advance(1)
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "took longer than 1 s"
    assert world.log[-1] == "C.halt"
    assert [(f.path, f.reason) for f in engine.take_halt_failures()] == [("/0/0/1", "cleaning up failed: no cloth")]


def test_a_failure_that_caused_the_halt_stays_the_failure_of_the_tree() -> None:
    def lost(reason: str) -> None:
        raise ActionFailed(reason)

    world = World()
    world.bind("Lose", lost)
    guard = n("Fallback", world.fn("G", "sf"), n("Lose", reason="no power"))
    engine = world.engine(n("ReactiveSequence", guard, tried(world.cls("A", "r"), n("Lose", reason="no cloth"))))
    assert world.ticks(engine, 2) == "rf"
    assert engine.failure is not None
    assert engine.failure.reason == "no power"


def test_a_port_without_value_is_false_and_told() -> None:
    world = World()
    engine = world.engine(n("TryCatch", world.cls("A", "r"), world.cls("B", "r"), catch_on_halt="{gone}"))
    engine.tick()
    engine.halt()
    assert world.log == ["A.start", "A.halt"]
    assert [failure.reason for failure in engine.take_halt_failures()] == ["{gone} has no value"]


@pytest.mark.parametrize("where", ["start", "halt"])
def test_an_interrupt_while_it_cleans_up_does_not_start_that_again(where: str) -> None:
    class Cleaning:
        def start(self) -> None:
            world.log.append("B.start")
            if where == "start":
                raise KeyboardInterrupt

        def tick(self) -> None: ...

        def halt(self) -> None:
            world.log.append("B.halt")
            if where == "halt":
                raise KeyboardInterrupt

    world = World()
    engine = world.engine(n("Parallel", tried(world.cls("A", "r"), world.bind("B", Cleaning)), world.cls("C", "r")))
    engine.tick()
    world.since()
    with pytest.raises(KeyboardInterrupt):
        engine.halt()
    assert world.since() == ["A.halt", "B.start", "B.halt", "C.halt"]
    assert engine.tick() == RUNNING
    assert world.since() == ["A.start", "C.start"]


def test_a_tick_that_was_cut_short_is_cleaned_up_after() -> None:
    world = World()
    engine = world.engine(tried(broken(world, "A", "start", KeyboardInterrupt()), world.cls("B", "s")))
    with pytest.raises(KeyboardInterrupt):
        engine.tick()
    assert world.log == ["start", "halt", "B.start"]


def test_all_that_a_tick_cut_short_has_started_is_halted_before_anything_is_cleaned_up() -> None:
    world = World()
    waiting = tried(world.cls("A", "r"), world.cls("B", "s"))
    engine = world.engine(n("Whenever", waiting, world.cls("C", "r"), broken(world, "X", "start", KeyboardInterrupt())))
    with pytest.raises(KeyboardInterrupt):
        engine.tick()
    assert world.log == ["A.start", "start", "A.halt", "halt", "B.start"]


def test_a_script_that_ends_it_cleans_up_too() -> None:
    world = World()
    engine = world.engine(n("TryCatch", world.cls("A", "r"), world.cls("B", "s"), catch_on_halt="1", _while="go == 1"))
    engine.blackboard.set("go", 1)
    assert world.ticks(engine, 1) == "r"
    engine.blackboard.set("go", 0)
    assert world.ticks(engine, 1) == "k"
    assert world.log == ["A.start", "A.halt", "B.start"]

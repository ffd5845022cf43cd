"""Where nodes go on after a halt and a suspension; test_guarantees.py has what holds for all of them."""

from __future__ import annotations

import pytest

from btlang.engine.status import IDLE, RUNNING
from btlang.tree.node import Node

from .scripted import World, n


def test_a_halted_sequence_starts_anew() -> None:
    world = World()
    engine = world.engine(n("Sequence", world.fn("A", "s"), world.cls("B", "r")))
    engine.tick()
    engine.halt()
    engine.tick()
    assert world.log == ["A", "B.start", "B.halt", "A", "B.start"]


def test_a_halted_sequence_with_memory_keeps_its_place() -> None:
    world = World()
    engine = world.engine(n("SequenceWithMemory", world.fn("A", "s"), world.cls("B", "r")))
    assert world.ticks(engine, 2) == "rr"
    engine.halt()
    engine.tick()
    assert world.log == ["A", "B.start", "B.halt", "B.start"]


def suspended(build: Node, world: World, before: int, after: int) -> tuple[str, list[str]]:
    """Ticks, suspends (twice, which must be the same), ticks on: the letters and log of the second part."""
    engine = world.engine(build)
    world.ticks(engine, before)
    engine.suspend()
    engine.suspend()
    world.since()
    return world.ticks(engine, after), world.since()


@pytest.mark.parametrize("id", ["Sequence", "AsyncSequence", "SequenceWithMemory"])
def test_suspended_sequences_keep_their_place(id: str) -> None:
    world = World()
    build = n(id, world.fn("A", "s"), world.cls("B", "rs"), world.fn("C", "s"))
    before = 1 if id == "Sequence" else 2
    assert suspended(build, world, before, 1) == ("s", ["B.start", "C"])


def test_suspend_halts_the_leaf_and_resuming_starts_it_anew() -> None:
    world = World()
    engine = world.engine(n("Sequence", world.fn("A", "s"), world.cls("B", "r"), world.fn("C", "s")), watched=True)
    engine.tick()
    world.changes.clear()
    engine.suspend()
    assert world.changes == [(2, IDLE), (0, IDLE)]
    assert engine.status == RUNNING
    engine.tick()
    assert world.log == ["A", "B.start", "B.halt", "B.start"]
    assert world.changes[2:] == [(2, RUNNING), (0, RUNNING)]


def test_a_suspended_fallback_keeps_its_place() -> None:
    world = World()
    assert suspended(n("Fallback", world.fn("A", "f"), world.cls("B", "rs")), world, 1, 1) == ("s", ["B.start"])


def test_suspended_parallels_keep_what_has_completed() -> None:
    world = World()
    build = n("Parallel", world.fn("A", "s"), world.cls("B", "rs"), world.fn("C", "s"))
    assert suspended(build, world, 1, 1) == ("s", ["B.start"])
    world = World()
    build = n("ParallelAll", world.fn("A", "f"), world.cls("B", "rs"))
    assert suspended(build, world, 1, 1) == ("f", ["B.start"])


def test_suspended_counts_stay() -> None:
    world = World()
    assert suspended(n("Repeat", world.fn("A", "s"), num_cycles=3), world, 2, 1) == ("s", ["A"])
    world = World()
    assert suspended(n("RetryUntilSuccessful", world.fn("A", "f"), num_attempts=3), world, 2, 1) == ("f", ["A"])


def test_a_suspended_round_still_counts_as_a_long_one() -> None:
    world = World()
    build = n("Repeat", world.cls("A", "rs"), num_cycles=2)
    assert suspended(build, world, 1, 1) == ("r", ["A.start", "A.start"])


def test_suspended_branches_stay_chosen() -> None:
    world = World()
    build = n("IfThenElse", world.fn("C", "sf"), world.cls("A", "rs"), world.fn("B", "s"))
    assert suspended(build, world, 1, 1) == ("s", ["A.start"])
    world = World()
    build = n("WhileDoElse", world.fn("C", "sf"), world.cls("A", "rs"), world.fn("B", "s"))
    assert suspended(build, world, 1, 1) == ("s", ["C", "B"])
    world = World()
    build = n("WhileDoElse", world.fn("C", "s"), world.cls("A", "rs"), world.fn("B", "s"))
    assert suspended(build, world, 1, 1) == ("s", ["C", "A.start"])


@pytest.mark.parametrize("id", ["ReactiveSequence", "ReactiveFallback"])
def test_suspended_reactive_nodes_ask_again_and_go_on(id: str) -> None:
    world = World()
    passes = "s" if id == "ReactiveSequence" else "f"
    inner = n("Sequence", world.fn("B", "s"), world.cls("C", "rs"))
    assert suspended(n(id, world.fn("A", passes), inner), world, 1, 1) == ("s", ["A", "C.start"])


def test_a_suspended_branch_that_is_left_is_reset() -> None:
    for id, script in (("ReactiveFallback", "fsf"), ("WhileDoElse", "sfs")):
        world = World()
        rest = n("Sequence", world.fn("B", "s"), world.cls("D", "r"))
        if id == "WhileDoElse":
            root = n(id, world.fn("C", script), rest, n("AlwaysSuccess"))
        else:
            root = n(id, n("Sequence", world.fn("C", script), n("Sleep", msec=1)), rest)
        engine = world.engine(root)
        engine.tick()
        engine.suspend()
        engine.tick()
        world.clock.advance(1)
        world.since()
        engine.tick()
        engine.tick()
        assert "B" in world.log, id


def test_suspended_timers_keep_the_time_that_has_passed() -> None:
    world = World()
    timers = {
        "Sleep": n("Sleep", msec=1000),
        "Delay": n("Delay", n("AlwaysSuccess"), delay_msec=1000),
        "Timeout": n("Timeout", world.cls("A", "r"), msec=1000),
    }
    for id, build in timers.items():
        engine = world.engine(build)
        engine.tick()
        world.clock.advance(0.3)
        engine.suspend()
        world.clock.advance(50)
        engine.tick()
        world.clock.advance(0.4)
        engine.suspend()
        world.clock.advance(50)
        engine.suspend()
        world.clock.advance(50)
        assert world.ticks(engine, 1) == "r", id
        world.clock.advance(0.25)
        assert world.ticks(engine, 1) == "r", id
        world.clock.advance(0.05)
        assert world.ticks(engine, 1) == ("f" if id == "Timeout" else "s"), id


def test_halting_a_suspended_tree_resets_it() -> None:
    world = World()
    engine = world.engine(n("Sequence", world.fn("A", "s"), n("Repeat", world.cls("B", "rs"), num_cycles=2)))
    engine.tick()
    engine.suspend()
    engine.halt()
    world.since()
    engine.tick()
    assert world.log == ["A", "B.start"]

"""Halting, suspending and resuming; the rule of reactive nodes."""

from __future__ import annotations

import pytest

from btlang.engine.status import IDLE, RUNNING
from btlang.tree.node import Node

from .scripted import World, n


def test_halt_reaches_every_running_leaf_once_and_in_order() -> None:
    world = World()
    both = n("Parallel", n("Sequence", world.fn("X", "s"), world.cls("A", "r")), n("Inverter", world.gen("B", "r")))
    engine = world.engine(n("Timeout", n("Fallback", both), msec=1000))
    engine.tick()
    world.since()
    engine.halt()
    assert world.since() == ["A.halt", "B.halt"]
    assert engine.status == IDLE
    engine.halt()
    assert world.since() == []


def test_halting_before_the_first_tick_and_after_the_last_does_nothing() -> None:
    world = World()
    engine = world.engine(n("Sequence", world.cls("A", "rs")))
    engine.halt()
    assert world.ticks(engine, 2) == "rs"
    engine.halt()
    assert world.log == ["A.start", "A.tick"]


def test_halts_are_reported_children_first() -> None:
    world = World()
    engine = world.engine(n("Sequence", n("Inverter", world.cls("A", "r"))), watched=True)
    engine.tick()
    world.changes.clear()
    engine.halt()
    assert world.changes == [(2, IDLE), (1, IDLE), (0, IDLE)]


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
    engine.tick()
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
    before = 2 if id == "AsyncSequence" else 1
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


# The reactive rule


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

"""The nodes of Nav2 together, as its trees use them, and nodes inside a pipeline."""

from __future__ import annotations

from btlang.engine.status import FAILURE
from btlang.tree.node import Node

from .scripted import World, n


def pipeline(world: World, first: Node, **ports: object) -> Node:
    return n("PipelineSequence", n("RateController", first, **ports), world.cls("Follow", "r"))


def plans(root: Node, world: World, ticks: int) -> str:
    """A letter for each tick of 0.25 s: P where the plan is made."""
    engine = world.engine(root)
    letters = ""
    for _ in range(ticks):
        world.log.clear()
        engine.tick()
        letters += "P" if "Plan" in world.log else "."
        world.clock.advance(0.25)
    return letters


def test_a_pipeline_plans_at_the_rate_and_follows_all_the_time() -> None:
    world = World()
    assert plans(pipeline(world, world.fn("Plan", "s"), hz=1), world, 10) == "P...P...P."
    world = World()
    assert plans(pipeline(world, world.fn("Plan", "s"), hz=2), world, 6) == "P.P.P."


def test_elsewhere_each_run_begins_at_once() -> None:
    world = World()
    root = n("Repeat", n("RateController", world.fn("Plan", "s"), hz=1), num_cycles=-1)
    assert plans(root, world, 4) == "PPPP"


def test_a_rate_counts_from_the_last_success() -> None:
    world = World()
    assert plans(pipeline(world, world.fn("Plan", "rrs"), hz=1), world, 9) == "PPP...PPP"


def test_a_suspended_rate_stands_still() -> None:
    world = World()
    engine = world.engine(pipeline(world, world.fn("Plan", "s"), hz=1))
    engine.tick()
    world.clock.advance(0.6)
    engine.suspend()
    world.clock.advance(100)
    world.since()
    engine.tick()
    assert world.since() == ["Follow.start"]
    world.clock.advance(0.5)
    engine.tick()
    assert world.since() == ["Plan", "Follow.tick"]


def test_a_pipeline_that_ended_starts_its_rate_anew() -> None:
    world = World()
    root = n("PipelineSequence", n("RateController", world.fn("Plan", "s"), hz=1), world.fn("Follow", "rs"))
    assert plans(root, world, 4) == "P.P."


def test_a_loop_that_is_over_stays_over_in_a_pipeline() -> None:
    world = World()
    root = n("PipelineSequence", n("LoopString", world.fn("A", "s"), queue="1;2"), world.fn("B", "rrrs"))
    engine = world.engine(root)
    assert world.ticks(engine, 6) == "rrrrrs"
    assert world.since() == ["A", "A", "B", "B", "B", "B"]
    assert world.ticks(engine, 1) == "r"
    assert world.since() == ["A"]


def test_recoveries_take_turns() -> None:
    world = World()
    recoveries = n("RoundRobin", world.fn("Clear", "s"), world.fn("Spin", "s"), world.fn("Wait", "s"))
    root = n("RecoveryNode", world.fn("Go", "f"), recoveries, number_of_retries=2)
    engine = world.engine(root)
    assert world.ticks(engine, 2) == "ff"
    assert world.log == ["Go", "Clear", "Go", "Spin", "Go", "Go", "Wait", "Go", "Clear", "Go"]


def test_the_failure_of_try_catch_is_that_of_what_was_tried() -> None:
    world = World()
    tried = n("Timeout", world.cls("A", "r"), msec=1000)
    engine = world.engine(
        n("TryCatch", tried, n("ForceSuccess", n("Fallback", world.fn("B", "f"), world.fn("C", "rf"))))
    )
    engine.tick()
    world.clock.advance(1)
    assert world.ticks(engine, 1) == "r"
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "took longer than 1 s"


def test_a_switch_resets_what_it_had_skipped() -> None:
    world = World()
    skipping = n("Repeat", world.fn("A", "sks"), num_cycles=2)
    root = n("Switch2", skipping, world.fn("B", "s"), world.fn("C", "s"), variable="{x}", case_1=1, case_2=2)
    engine = world.engine(root)
    letters = ""
    for x in (1, 1, 2, 1):
        engine.blackboard.set("x", x)
        letters += world.ticks(engine, 1)
    assert letters == "rksr"  # the count of the first round is forgotten


def test_a_single_trigger_fails_once_its_child_has_ended_where_it_stays_completed() -> None:
    for parent, statuses in (("PipelineSequence", "rf"), ("NonblockingSequence", "rf"), ("Sequence", "rr")):
        world = World()
        engine = world.engine(n(parent, n("SingleTrigger", world.fn("Beep", "s")), world.cls("Follow", "r")))
        assert world.ticks(engine, 2) == statuses
        assert world.log.count("Beep") == 1

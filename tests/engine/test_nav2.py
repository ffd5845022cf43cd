"""The nodes of Nav2 together, as its trees use them, and nodes inside a pipeline."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from btlang.engine.instance import EngineError
from btlang.engine.status import FAILURE
from btlang.robots.geometry import Pose
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


def moved(first: Node, ports: str, values: list[float], robot: str) -> str:
    """A letter for each tick of 0.25 s, P where the plan is made: x, a pose or a speed has these values."""
    world = World()
    engine = world.engine(
        n("PipelineSequence", first.replace(children=(world.fn("Plan", "s"),)), world.cls("Follow", "r"))
    )
    letters = ""
    for value in values:
        if robot:
            setattr(world.robot.base, robot, Pose(value, 0.0, 0.0) if robot == "pose" else (value, 0.0))
        engine.blackboard.set("goal", value if ports else 0)
        world.log.clear()
        engine.tick()
        letters += "P" if "Plan" in world.log else "."
        world.clock.advance(0.25)
    return letters


def test_a_distance_controller_plans_each_metre() -> None:
    places = [0.0, 0.4, 0.9, 1.0, 1.6, 2.1, 1.2, 1.0]
    assert moved(n("DistanceController"), "", places, "pose") == "P..P.P.P"
    assert moved(n("DistanceController", distance="0.5"), "", places, "pose") == "P.P.PPP."


def test_a_speed_controller_plans_the_more_often_the_faster_it_drives() -> None:
    ports = {"min_rate": 0.5, "max_rate": 2, "max_speed": 1}
    assert moved(n("SpeedController", **ports), "", [1.0] * 9, "velocity") == "P.P.P.P.P"
    assert moved(n("SpeedController", **ports), "", [0.0] * 12, "velocity") == "P.P.......P."
    assert moved(n("SpeedController", **ports), "", [1 / 3] * 11, "velocity") == "P.P...P...P"
    assert moved(n("SpeedController", min_speed=1, max_speed=1), "", [2.0] * 9, "velocity") == "P...P...P"
    assert moved(n("SpeedController"), "goal", [1, 1, 2, 2, 3, 3, 3], "") == "P.P.P.."


def test_a_new_goal_is_planned() -> None:
    assert moved(n("GoalUpdatedController"), "goal", [1, 1, 2, 2, 1, 1], "") == "P.P.P."
    assert moved(n("GoalUpdatedController", goal="{goal}"), "goal", [1, 1, 2], "") == "P.P"
    assert moved(n("GoalUpdatedController", goal="{other}"), "goal", [1, 1, 2], "") == "P.."


def test_a_goal_updater_passes_on_the_goal_as_it_is_now() -> None:
    world = World()
    engine = world.engine(n("GoalUpdater", world.cls("Follow", "r"), input_goal="{goal}", output_goal="{new}"))
    engine.tick()
    assert "new" not in engine.blackboard  # there's no goal yet
    for goal in (1, 2):
        engine.blackboard.set("goal", goal)
        engine.tick()
        assert engine.blackboard.get("new") == goal


@pytest.mark.parametrize("id", ["DistanceController", "SpeedController"])
def test_a_robot_without_a_base_is_a_failure(id: str) -> None:
    world = World()
    del world.robot.base
    engine = world.engine(n("PipelineSequence", n(id, world.fn("Plan", "s")), world.cls("Follow", "r")))
    engine.tick()
    world.clock.advance(1)
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "this robot has no base"


@pytest.mark.parametrize("value", [None, -1, 3, "one", 0.5])
def test_a_persistent_sequence_needs_a_position(value: object) -> None:
    world = World()
    engine = world.engine(n("PersistentSequence", world.fn("A", "s"), world.fn("B", "s"), current_child_idx="{at}"))
    if value is not None:
        engine.blackboard.set("at", value)
    assert engine.tick() == FAILURE
    assert world.log == []
    with pytest.raises(EngineError, match="must be a"):
        world.engine(n("PersistentSequence", world.fn("A", "s"), current_child_idx="0"))


def test_a_path_that_became_longer_near_the_goal_runs_the_child() -> None:
    """The path is a message, a list of points or JSON; without one there's nothing to compare."""
    world = World()
    engine = world.engine(n("PathLongerOnApproach", world.fn("Wait", "s"), path="{path}", prox_len="2"))
    assert world.ticks(engine, 1) == "s"

    def message(length: float) -> Any:
        positions = [SimpleNamespace(x=length, y=0.0, z=0.0), SimpleNamespace(x=0.0, y=0.0, z=0.0)]
        return SimpleNamespace(poses=[SimpleNamespace(pose=SimpleNamespace(position=each)) for each in positions])

    asked = []
    for path in (
        message(2),
        message(5),
        message(1),
        [[3, 0], [0, 0]],
        'json:{"poses": [[1, 0], [0, 0]]}',
        message(2.5),
        [],
    ):
        engine.blackboard.set("path", path)
        world.log.clear()
        assert world.ticks(engine, 1) == "s"
        asked.append("Wait" in world.log)
    assert asked == [False, False, False, True, False, True, False]
    for wrong in (3, "soon", [[1]], [["a", "b"]], [None]):
        engine.blackboard.set("path", wrong)
        assert engine.tick() == FAILURE
        assert engine.failure is not None
        assert engine.failure.reason.startswith("path must be a path, such as json:[[0, 0], [1, 2]], not ")

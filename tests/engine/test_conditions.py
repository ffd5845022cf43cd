"""Pre- and post-conditions beyond the tables of docs/engine.md: failures, order, scopes, what a listener is told."""

from __future__ import annotations

import pytest

from btlang.engine.instance import EngineError
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.tree.node import Tree

from .scripted import World, n


def test_a_failure_by_a_pre_condition_says_which() -> None:
    engine = World().engine(n("Sequence", n("AlwaysSuccess", _failureIf="1 < 2")))
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert (engine.failure.path, engine.failure.reason) == ("/0", "_failureIf holds: 1 < 2")


@pytest.mark.parametrize("port", ["_failureIf", "_successIf", "_onlyIf", "_skipIf", "_while", "_onSuccess", "_post"])
def test_a_script_that_cannot_go_on_is_the_reason(port: str) -> None:
    engine = World().engine(n("AlwaysSuccess", **{port: "gone + 1"}))
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "{gone} has no value"


def test_a_text_is_no_answer() -> None:
    engine = World().engine(n("AlwaysSuccess", _skipIf="'yes'"))
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "the text 'yes' is neither true nor false"


def test_a_while_that_cannot_go_on_halts_the_node() -> None:
    world = World()
    node = world.cls("A", "r").replace(ports=(("_while", "x == 0"), ("_onFailure", "failed := 1")))
    engine = world.engine(n("Sequence", n("Script", code="x := 0"), node))
    assert engine.tick() == RUNNING
    engine.blackboard.unset("x")
    assert engine.tick() == FAILURE
    assert world.log == ["A.start", "A.halt"]
    assert engine.blackboard.get("failed") == 1


def test_a_script_that_cannot_go_on_while_halting_is_kept() -> None:
    world = World()
    engine = world.engine(world.cls("A", "r").replace(ports=(("_onHalted", "gone += 1"),)))
    engine.tick()
    engine.halt()
    [failure] = engine.take_halt_failures()
    assert failure.reason.startswith("{gone} has no value")
    assert failure.path == "/"


def test_children_are_halted_before_their_parents() -> None:
    world = World()
    leaf = world.cls("A", "r").replace(ports=(("_onHalted", "order := order .. 'leaf '"),))
    root = n(
        "Sequence", n("Inverter", leaf, _onHalted="order := order .. 'inverter '"), _onHalted="order := order .. 'root'"
    )
    engine = world.engine(root)
    engine.blackboard.set("order", "")
    engine.tick()
    engine.suspend()
    assert engine.blackboard.get("order") == ""
    engine.halt()
    assert engine.blackboard.get("order") == "leaf inverter root"


def test_a_reactive_node_runs_the_scripts_of_what_it_halts() -> None:
    world = World()
    first = n("Sequence", world.fn("C", "fs"), world.cls("A", "r"))
    second = world.cls("B", "r").replace(ports=(("_onHalted", "stopped := 1"),))
    engine = world.engine(n("ReactiveFallback", first, second))
    world.ticks(engine, 2)
    assert world.log == ["C", "B.start", "C", "B.halt", "A.start"]
    assert engine.blackboard.get("stopped") == 1


def test_scripts_of_a_subtree_see_the_blackboard_around_it() -> None:
    body = n("Script", code="inner := outer")
    use = n("SubTree", ID="go", outer="{x}", _skipIf="x > 1", _onSuccess="x := 2")
    engine = World().engine(Tree(n("Sequence", use, use), (("go", body),)))
    engine.blackboard.set("x", 1)
    assert engine.tick() == SUCCESS
    assert engine.blackboard.keys() == ["x"]
    assert engine.tick() == SKIPPED


def test_enums_are_numbers_in_all_scripts_and_cases() -> None:
    world = World()
    branches = world.fn("A", "s"), world.fn("B", "s"), world.fn("C", "s")
    root = n(
        "Sequence",
        n("Script", code="color := RED", _skipIf="BLUE == 1"),
        n("ScriptCondition", code="color == 3"),
        n("Switch2", *branches, variable="{color}", case_1="BLUE", case_2="RED"),
        n("Precondition", world.fn("D", "s"), **{"if": "color == RED"}),
    )
    engine = world.engine(root, enums={"RED": 3, "BLUE": 4})
    assert engine.tick() == SUCCESS
    assert world.log == ["B", "D"]


@pytest.mark.parametrize("id", ["Sequence", "ReactiveSequence", "Parallel", "AsyncSequence", "SequenceWithMemory"])
def test_the_next_child_follows_one_that_was_decided(id: str) -> None:
    world = World()
    engine = world.engine(
        n(id, n("Sequence", _successIf="true").replace(children=(world.fn("A", "f"),)), world.fn("B", "f"))
    )
    while (status := engine.tick()) == RUNNING:
        pass
    assert (status, world.log) == (FAILURE, ["B"])


def test_a_node_that_was_decided_is_told_to_a_listener() -> None:
    world = World()
    engine = world.engine(n("Sequence", world.cls("A", "r").replace(ports=(("_successIf", "true"),))), watched=True)
    assert engine.tick() == SUCCESS
    assert world.changes == [(1, SUCCESS), (0, SUCCESS)]
    assert world.log == []


def test_constant_conditions_cost_nothing() -> None:
    """A node that is always skipped keeps nothing below it, and one that never is stays as it is."""
    world = World()
    assert world.engine(n("AlwaysSuccess", _skipIf="false")).tick() == SUCCESS
    assert world.engine(n("Inverter", world.cls("A", "r"), _skipIf="true")).tick() == SKIPPED
    assert world.log == []


def test_ten_thousand_levels_with_conditions() -> None:
    world = World()
    root = world.cls("A", "rrs")
    for _ in range(10_000):
        root = n("Inverter", root, _while="true", _post="1")
    engine = world.engine(root, watched=True)
    assert world.ticks(engine, 1) == "r"
    engine.halt()
    assert world.ticks(engine, 2) == "rs"


@pytest.mark.parametrize("port", ["_uid", "_fullpath", "_description", "_collapsed", "_path"])
def test_what_editors_write_does_nothing(port: str) -> None:
    assert World().engine(n("Sequence", n("AlwaysSuccess"), **{port: "1"})).tick() == SUCCESS


@pytest.mark.parametrize("port", ["_onHalt", "_skipif", "_onsucces", "_autoremap"])
def test_misspelt_conditions_are_unknown(port: str) -> None:
    with pytest.raises(EngineError, match=f"Sequence takes no port {port}"):
        World().engine(n("Sequence", n("AlwaysSuccess"), **{port: "1"}))

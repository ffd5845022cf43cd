"""Loops over queues, entries that are set anew, and the leaves that set and unset them."""

from __future__ import annotations

from collections import deque
from copy import copy
from typing import Any

import pytest

from btlang.engine.engine import Engine
from btlang.engine.instance import EngineError
from btlang.engine.status import FAILURE, SUCCESS
from btlang.tree.node import Node

from .scripted import World, n


def values(world: World, id: str, **ports: object) -> tuple[Engine, list[Any]]:
    """A loop whose child notes the values that it gets."""
    seen: list[Any] = []
    world.bind("Note", lambda value: seen.append(value))
    return world.engine(n(id, n("Note", value="{v}"), value="{v}", **ports)), seen


@pytest.mark.parametrize(
    ("id", "queue", "taken"),
    [
        ("LoopInt", "1;-2", [1, -2]),
        ("LoopBool", "true;0", [True, False]),
        ("LoopDouble", "1.0;2.5", [1, 2.5]),
        ("LoopString", "a b;;c;", ["a b", "", "c"]),
        ("LoopString", "", []),
    ],
)
def test_queues_in_texts(id: str, queue: str, taken: list[Any]) -> None:
    engine, seen = values(world := World(), id, queue=queue)
    assert world.ticks(engine, len(taken) + 1) == "r" * len(taken) + "s"
    assert seen == taken
    assert [type(value) for value in seen] == [type(value) for value in taken]


@pytest.mark.parametrize(
    ("held", "left"), [(deque(("1", 2)), deque()), (["1", 2], []), (("1", 2), deque()), ("1;2", deque())]
)
def test_queues_on_the_blackboard_are_taken_apart_there(held: Any, left: Any) -> None:
    held = copy(held)  # the case itself stays
    engine, seen = values(world := World(), "LoopInt", queue="{q}")
    engine.blackboard.set("q", held)
    assert world.ticks(engine, 2) == "rr"
    assert seen == [1, 2]
    assert engine.blackboard.get("q") == left
    assert world.ticks(engine, 1) == "s"
    if isinstance(held, (list, deque)):
        held.append(3)  # it is the same object
        assert world.ticks(engine, 2) == "rs"
        assert seen == [1, 2, 3]


@pytest.mark.parametrize(
    ("held", "reason"),
    [
        (7, "{q} holds 7, which isn't a queue"),
        ("1;two", "the queue must hold whole numbers, not 'two'"),
    ],
)
def test_what_is_no_queue(held: Any, reason: str) -> None:
    engine, _ = values(World(), "LoopInt", queue="{q}")
    engine.blackboard.set("q", held)
    while (status := engine.tick()) not in (FAILURE, SUCCESS):
        pass
    assert status == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == reason


@pytest.mark.parametrize(
    ("node", "message"),
    [
        (n("LoopInt", n("AlwaysSuccess"), queue="1;x"), "the queue must hold whole numbers, not 'x'"),
        (n("LoopInt", n("AlwaysSuccess")), "LoopInt needs a port queue"),
        (n("LoopInt", n("AlwaysSuccess"), queue="1", value="v"), "value is an output: it must be a {key}, not 'v'"),
        (n("LoopInt", n("AlwaysSuccess"), queue="1", if_empty="RUNNING"), "if_empty must be SUCCESS or FAILURE or SKI"),
        (n("SkipUnlessUpdated", n("AlwaysSuccess")), "SkipUnlessUpdated needs a port entry"),
        (n("UnsetBlackboard"), "UnsetBlackboard needs a port key"),
        (n("SetBlackboard", output_key="x"), "SetBlackboard needs a port value"),
        (n("SetBlackboard", value="x"), "SetBlackboard needs a port output_key"),
        (n("RunOnce", n("AlwaysSuccess"), then_skip="yes"), "then_skip must be true or 1 or false or 0, not 'yes'"),
        (n("Precondition", n("AlwaysSuccess")), "Precondition needs a port if"),
        (n("Precondition", n("AlwaysSuccess"), **{"if": "1 +"}), "its if '1 +' cannot be read: a value is missing"),
        (n("RateController", n("AlwaysSuccess"), hz="0"), "hz must be a number above 0, not '0'"),
        (n("TryCatch", n("AlwaysSuccess")), "TryCatch has 1 child instead of 2 or more"),
        (n("TryCatch", *[n("AlwaysSuccess")] * 2, catch_on_halt="yes"), "catch_on_halt must be true or 1 or false "),
        (n("Switch2", *[n("AlwaysSuccess")] * 2, variable="1"), "Switch2 has 2 children instead of 3"),
        (n("Switch2", *[n("AlwaysSuccess")] * 3, case_3="1"), "Switch2 takes no port case_3"),
        (n("RecoveryNode", n("AlwaysSuccess")), "RecoveryNode has 1 child instead of 2"),
    ],
)
def test_errors_of_compiling(node: Node, message: str) -> None:
    with pytest.raises(EngineError) as raised:
        World().engine(n("Sequence", node))
    assert raised.value.message.startswith(message)
    assert raised.value.node == node


@pytest.mark.parametrize(
    ("held", "set_to", "result"),
    [
        (1, "2.5", 2.5),
        (2.5, "3", 3),
        (1, "true", 1),
        ("a", "5", "5"),
        (None, "5", "5"),
        (True, "0", 0),
        ([1], "x", "x"),
    ],
)
def test_an_entry_that_holds_a_number_keeps_its_kind(held: Any, set_to: str, result: Any) -> None:
    engine = World().engine(n("SetBlackboard", value=set_to, output_key="x"))
    engine.blackboard.set("x", held)
    assert engine.tick() == SUCCESS
    assert engine.blackboard.get("x") == result


def test_a_text_that_is_no_number_does_not_replace_one() -> None:
    engine = World().engine(n("SetBlackboard", value="{text}", output_key="{x}"))
    engine.blackboard.set("x", 1)
    engine.blackboard.set("text", "many")
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "{x} holds a number: the text 'many' isn't a number"


def test_was_entry_updated() -> None:
    world = World()
    engine = world.engine(n("WasEntryUpdated", entry="x"))
    assert world.ticks(engine, 1) == "f"
    engine.blackboard.set("x", 1)
    assert world.ticks(engine, 2) == "sf"
    engine.blackboard.unset("x")
    assert world.ticks(engine, 1) == "f"
    engine.blackboard.set("x", 1)
    engine.blackboard.set("x", 1)
    assert world.ticks(engine, 2) == "sf"


def test_each_node_has_its_own_news() -> None:
    world = World()
    engine = world.engine(n("ParallelAll", *[n("WasEntryUpdated", entry="x")] * 2))
    engine.blackboard.set("x", 1)
    assert world.ticks(engine, 2) == "sf"


def test_unset() -> None:
    engine = World().engine(n("Sequence", n("UnsetBlackboard", key="{x}"), n("UnsetBlackboard", key="y")))
    engine.blackboard.set("x", 1)
    assert engine.tick() == SUCCESS
    assert engine.blackboard.keys() == []

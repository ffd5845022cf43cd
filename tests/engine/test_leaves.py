"""What a leaf may be, how ports reach it, and what becomes of its exceptions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from btlang.engine.blackboard import Blackboard
from btlang.engine.engine import Engine
from btlang.engine.instance import EngineError
from btlang.engine.leaves.leaf import ActionFailed, Failed, LeafBinding
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.tree.node import Node, Tree

from .scripted import World, broken, n


def outcome(call: Any, world: World | None = None, parent: str = "", **ports: str) -> tuple[int, str]:
    """Status and reason of one tick of a leaf, by itself or as the only child of a parent."""
    world = world or World()
    world.bind("A", call)
    leaf = n("A", **ports)
    engine = world.engine(n(parent, leaf) if parent else leaf)
    status = engine.tick()
    return status, engine.failure.reason if engine.failure else ""


@pytest.mark.parametrize(
    ("value", "status", "reason"),
    [
        (True, SUCCESS, ""),
        (None, SUCCESS, ""),
        (False, FAILURE, "it returned False"),
        (Failed("it is dark"), FAILURE, "it is dark"),
        (Failed(lambda: "it is dark"), FAILURE, "it is dark"),
        (Failed(lambda: str(1 // 0)), FAILURE, "ZeroDivisionError: integer division or modulo by zero"),
        (np.bool_(True), SUCCESS, ""),
        (np.bool_(False), FAILURE, "it returned False"),
        (RUNNING, RUNNING, ""),
        (SKIPPED, SKIPPED, ""),
        (1, SUCCESS, ""),
        (0, FAILURE, "it returned False"),
    ],
)
@pytest.mark.parametrize("parent", ["", "Sequence", "Fallback", "ReactiveSequence", "ReactiveFallback", "ParallelAll"])
def test_values_of_functions(parent: str, value: object, status: int, reason: str) -> None:
    assert outcome(lambda: value, parent=parent) == (status, reason)


@pytest.mark.parametrize("value", [IDLE, 5, -1, "yes", 2.5, [], object, np.array([1, 2])])
@pytest.mark.parametrize("parent", ["", "Sequence", "Fallback", "ReactiveSequence", "ReactiveFallback", "Parallel"])
def test_other_values_are_failures(parent: str, value: object) -> None:
    status, reason = outcome(lambda: value, parent=parent)
    assert status == FAILURE
    assert "it returned" in reason or (isinstance(value, np.ndarray) and "ValueError" in reason)


def test_generators_run_until_they_return() -> None:
    def steps(value: str) -> Iterator[None]:
        yield
        yield
        return value == "yes"  # type: ignore[return-value]

    world = World()
    world.bind("A", steps)
    assert world.ticks(world.engine(n("A", value="yes")), 4) == "rrsr"
    assert world.ticks(world.engine(n("A", value="no")), 3) == "rrf"


def test_halting_closes_a_generator() -> None:
    log = []

    def steps() -> Iterator[None]:
        try:
            while True:
                yield
        finally:
            log.append("stopped")

    world = World()
    world.bind("A", steps)
    engine = world.engine(n("A"))
    engine.tick()
    engine.halt()
    assert log == ["stopped"]
    assert world.ticks(engine, 1) == "r"


def test_a_class_is_made_once_for_its_node_and_none_is_running() -> None:
    made = []

    class Leaf:
        def __init__(self, robot: str) -> None:
            made.append(robot)
            self.left = 0

        def start(self, rounds: int) -> bool | None:
            self.left = rounds
            return None if rounds else True

        def tick(self) -> bool | None:
            self.left -= 1
            return None if self.left else True

        def halt(self) -> None: ...

    world = World()
    world.bind("A", Leaf, converters={"rounds": int})
    engine = world.engine(n("Sequence", n("A", rounds="2"), n("A", rounds="0")), services={"robot": "r2"})
    assert world.ticks(engine, 6) == "rrsrrs"
    assert made == ["r2", "r2"]


def test_parameters_are_filled_from_ports_then_services_then_defaults() -> None:
    seen: dict[str, object] = {}

    def call(place: int, robot: str, clock: object, blackboard: object, speed: float = 0.5, **rest: str) -> None:
        seen.update(rest, place=place, robot=robot, clock=clock, blackboard=blackboard, speed=speed)

    world = World()
    world.bind("A", call, converters={"place": int}, defaults={"place": "7", "extra": "e"})
    engine = world.engine(n("A", other="x"), services={"robot": "r2", "unused": 1})
    assert engine.tick() == SUCCESS
    assert seen == {
        "place": 7, "robot": "r2", "clock": world.clock, "blackboard": engine.blackboard, "speed": 0.5,
        "extra": "e", "other": "x",
    }  # fmt: skip


def test_keys_are_read_at_each_start_and_text_is_converted() -> None:
    seen: list[object] = []
    world = World()
    world.bind("A", lambda x: seen.append(x), converters={"x": int})
    blackboard = Blackboard()
    engine = world.engine(n("A", x="{n}"), blackboard=blackboard)
    for value in ("3", 4.5):
        blackboard.set("n", value)
        assert engine.tick() == SUCCESS
    assert seen == [3, 4.5]
    blackboard.set("n", "many")
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason.startswith("x cannot be 'many': a whole number is needed")


def test_only_a_whole_text_in_braces_is_a_key() -> None:
    seen: list[object] = []
    assert outcome(lambda x: seen.append(x), x="{a} and {b}") == (SUCCESS, "")
    assert outcome(lambda x: seen.append(x), x="{}") == (SUCCESS, "")
    assert seen == ["{a} and {b}", "{}"]
    assert outcome(lambda x: None, x="{=}") == (FAILURE, "{x} has no value")


def test_a_key_without_value_interrupts_nothing_and_starts_nothing() -> None:
    world = World()

    class Leaf:
        def start(self, x: str) -> None:
            world.log.append("A.start")

        def tick(self) -> None: ...

        def halt(self) -> None: ...

    world.bind("A", Leaf)
    engine = world.engine(n("ReactiveFallback", n("A", x="{gone}"), world.cls("B", "r")), watched=True)
    assert world.ticks(engine, 2) == "rr"
    assert world.log == ["B.start", "B.tick"]
    assert world.changes == [(1, FAILURE), (2, RUNNING), (0, RUNNING)]


# Failures


def test_a_failed_action_gives_its_reason() -> None:
    def call() -> None:
        raise ActionFailed("nothing within reach")

    assert outcome(call) == (FAILURE, "nothing within reach")


def test_a_failure_without_a_reason_says_so() -> None:
    def call() -> None:
        raise ActionFailed

    assert outcome(call) == (FAILURE, "it gave no reason")
    assert outcome(lambda: Failed("")) == (FAILURE, "it gave no reason")


def test_what_a_returned_false_means_is_said_by_the_binding() -> None:
    world = World()
    engine = world.engine(world.bind("A", lambda: False, refusal="it is dark"))
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert (engine.failure.reason, engine.reason(0)) == ("it is dark", "it is dark")


@pytest.mark.parametrize(("where", "log"), [("start", ["start", "halt"]), ("tick", ["start", "tick", "halt"])])
def test_an_exception_fails_the_leaf_and_halts_it(where: str, log: list[str]) -> None:
    world, problem = World(), ValueError("no map")
    for around in ("Fallback", "Inverter"):  # what raises hasn't said no
        world.log.clear()
        engine = world.engine(n("Fallback", n(around, broken(world, "A", where, problem))))
        letters = world.ticks(engine, len(log) - 1)
        assert letters[-1] == "f"
        assert world.log == log
        assert engine.failure is not None
        assert engine.failure.reason == "ValueError: no map"
        assert engine.failure.exception is problem


def test_a_failed_action_is_not_halted() -> None:
    world = World()
    engine = world.engine(broken(world, "A", "tick", ActionFailed("lost")))
    assert world.ticks(engine, 2) == "rf"
    engine.halt()
    assert world.log == ["start", "tick"]


def test_exceptions_of_functions_and_generators() -> None:
    def function() -> None:
        raise KeyError("k")

    def generator() -> Iterator[None]:
        raise OSError("gone")
        yield

    def endless() -> Iterator[None]:
        raise StopIteration
        yield

    assert outcome(function) == (FAILURE, "KeyError: 'k'")
    assert outcome(generator) == (FAILURE, "OSError: gone")
    assert outcome(endless) == (FAILURE, "RuntimeError: generator raised StopIteration")


def test_failure_names_what_made_the_root_fail() -> None:
    def lost() -> None:
        raise ActionFailed("lost")

    world = World()
    engine = world.engine(n("Sequence", n("Fallback", world.fn("B", "f"), world.bind("A", lost))))
    engine.tick()
    assert engine.failure is not None
    assert (engine.failure.node.id, engine.failure.path, engine.failure.reason) == ("A", "/0/1", "lost")
    engine = world.engine(n("Inverter", world.fn("B", "s")))
    engine.tick()
    assert engine.failure is not None
    assert (engine.failure.node.id, engine.failure.reason) == ("Inverter", "it is true")
    engine = world.engine(n("Fallback", world.fn("B", "f"), world.fn("C", "s")))
    engine.tick()
    assert engine.failure is None


# What cannot be compiled


class NoHalt:
    def start(self) -> None: ...

    def tick(self) -> None: ...


@pytest.mark.parametrize(
    ("node", "call", "message"),
    [
        (n("Other"), print, "nothing is bound to Other"),
        (n("A", x="1"), lambda: None, "A takes no port x"),
        (n("A", x="1"), lambda y=0: None, "A takes no port x; it takes y"),
        (n("A"), lambda x: None, "A needs a value for x"),
        (n("A", x="1"), lambda x, /: None, "A takes no port x"),
        (n("A", x="one"), lambda x: None, "x cannot be 'one': a whole number is needed"),
        (n("A"), NoHalt, "NoHalt has no halt, so it isn't a leaf"),
        (n("A", n("AlwaysSuccess")), lambda: None, "A is a leaf, which takes no children"),
        (n("Sequence"), None, "Sequence has 0 children instead of 1 or more"),
        (n("Inverter"), None, "Inverter has 0 children instead of 1"),
        (n("IfThenElse", n("AlwaysSuccess")), None, "IfThenElse has 1 child instead of 2 or 3"),
        (n("Repeat", n("AlwaysSuccess")), None, "Repeat needs a port num_cycles"),
        (n("Repeat", n("AlwaysSuccess"), num_cycles="1.0"), None, "num_cycles must be a whole number from -1 "),
        (n("Timeout", n("AlwaysSuccess"), msec="-5"), None, "msec must be a whole number from 0 "),
        (n("Sleep", msec="1", seconds="1"), None, "Sleep takes no port seconds"),
        (n("AlwaysSuccess", _skipIf="x >"), None, "its _skipIf 'x >' cannot be read: a value is missing"),
        (n("AlwaysSuccess", _onHalt="1"), None, "AlwaysSuccess takes no port _onHalt"),
        (n("A", _autoremap="true"), lambda: None, "A takes no port _autoremap"),
        (n("SubTree", ID="nowhere"), None, "there is no subtree nowhere"),
        (n("SubTree"), None, "SubTree needs a port ID"),
    ],
)
def test_errors_of_compiling(node: Node, call: Any, message: str) -> None:
    bindings = {"A": LeafBinding(call, converters={"x": int})}
    with pytest.raises(EngineError) as raised:
        Engine(Tree(n("Sequence", node)), bindings.get, clock=World().clock)
    assert raised.value.message.startswith(message)
    assert raised.value.node == node

"""Conditions that do not know: what is not known is neither true nor false."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine, Failure
from btlang.engine.instance import EngineError
from btlang.engine.leaves.leaf import LeafBinding, Unknown
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.tree.node import Node, Tree


class World:
    """A sensor that knows or not, and what was done."""

    def __init__(self) -> None:
        self.knows: bool | None = None
        self.done: list[str] = []
        self.told: list[Failure] = []

    def sense(self) -> bool:
        if self.knows is None:
            raise Unknown("the sensor is silent")
        return self.knows

    def bind(self, node_id: str) -> LeafBinding:
        return LeafBinding(self.sense if node_id == "Sense" else lambda: self.done.append(node_id))

    def engine(self, root: Node, *, watched: bool = False) -> Engine:
        listener = (lambda changes: None) if watched else None
        return Engine(Tree(root), self.bind, clock=Clock(), listener=listener, on_warning=self.told.append)


SENSE, ACT, OTHER = Node("Sense"), Node("Act"), Node("Other")
NOT = Node("Inverter", (SENSE,))
FALSE, TRUE = Node("AlwaysFailure"), Node("AlwaysSuccess")
SLEEP = Node("Sleep", (), (("msec", "1000"),))


@pytest.mark.parametrize("watched", [False, True])
@pytest.mark.parametrize(
    "root",
    [
        SENSE,
        NOT,
        Node("Inverter", (NOT,)),
        Node("Inverter", (Node("Fallback", (SENSE, FALSE)),)),
        Node("Inverter", (Node("Sequence", (TRUE, SENSE)),)),
        Node("IfThenElse", (SENSE, ACT, OTHER)),
        Node("IfThenElse", (NOT, ACT, OTHER)),
        Node("IfThenElse", (SENSE, ACT)),
        Node("WhileDoElse", (SENSE, ACT, OTHER)),
        Node("WhileDoElse", (NOT, ACT, OTHER)),
        Node("ReactiveSequence", (NOT, ACT)),
    ],
    ids=str,
)
def test_what_asks_it_fails_with_its_reason(root: Node, watched: bool) -> None:
    world = World()
    engine = world.engine(root, watched=watched)
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert (engine.failure.node, engine.failure.reason) == (SENSE, "the sensor is silent")
    assert world.done == []


def test_an_alternative_that_is_true_decides() -> None:
    world = World()
    engine = world.engine(Node("IfThenElse", (Node("Fallback", (SENSE, TRUE)), ACT, OTHER)))
    assert (engine.tick(), world.done) == (SUCCESS, ["Act"])


def test_a_loop_is_halted_when_its_condition_is_lost() -> None:
    world = World()
    engine = world.engine(Node("WhileDoElse", (SENSE, SLEEP, OTHER)))
    world.knows = True
    assert engine.tick() == RUNNING
    world.knows = None
    assert (engine.tick(), world.done) == (FAILURE, [])


def test_a_standing_rule_waits_and_tells_of_it_once() -> None:
    world = World()
    engine = world.engine(Node("Whenever", (SENSE, ACT, SLEEP)))
    for knows in (None, None, True, None, True):
        world.knows = knows
        assert engine.tick() == RUNNING
    assert world.done == ["Act"]  # it was not false in between
    assert [(failure.node, failure.reason) for failure in world.told] == [(SENSE, "the sensor is silent")]
    engine.halt()
    world.knows = None
    engine.tick()
    assert len(world.told) == 2  # of a new run


def test_an_unknown_answer_of_another_tick_does_not_count() -> None:
    world = World()
    engine = world.engine(NOT)
    assert engine.tick() == FAILURE
    world.knows = False
    assert engine.tick() == SUCCESS


@pytest.mark.parametrize("id", ["Inverter", "IfThenElse"])
def test_a_condition_that_took_time_may_end_unknown(id: str) -> None:
    """Its next tick doesn't pass the nodes that wait for it."""
    world = World()
    condition = Node("ReactiveSequence", (SENSE, SLEEP))
    branches = () if id == "Inverter" else (ACT, OTHER)
    engine = world.engine(Node("Sequence", (Node(id, (condition, *branches)), ACT)))
    world.knows = True
    assert engine.tick() == RUNNING
    world.knows = None
    assert (engine.tick(), world.done) == (FAILURE, [])
    assert engine.failure is not None
    assert engine.failure.reason == "the sensor is silent"


@pytest.mark.parametrize("root", [
    Node("ScriptCondition", (), (("code", "gone > 1"),)),
    Node("Precondition", (TRUE,), (("if", "gone > 1"), ("else", "FAILURE"))),
    Node("Act", (), (("_skipIf", "gone > 1"),)),
], ids=str)  # fmt: skip
def test_a_script_that_cannot_be_worked_out_is_unknown(root: Node) -> None:
    world = World()
    engine = world.engine(Node("IfThenElse", (root, ACT, OTHER)))
    assert (engine.tick(), world.done) == (FAILURE, [])
    assert [failure.node for failure in world.told] == [root]


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (None, "it returned nothing, and a condition has to return True or False"),
        (2, "it returned 2, which is no answer: return True or False, as in bool(...)"),
        (0, "it returned 0, which is no answer: return True or False, as in bool(...)"),
    ],
)
def test_what_is_no_answer_is_neither_yes_nor_no(answer: object, reason: str) -> None:
    bindings = {"Sense": LeafBinding(lambda: answer, condition=True), "Act": LeafBinding(lambda: None)}
    engine = Engine(Tree(Node("IfThenElse", (SENSE, ACT, ACT))), bindings.__getitem__, clock=Clock())
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == reason


def test_a_condition_does_not_yield() -> None:
    def sense() -> Iterator[bool]:
        yield True

    with pytest.raises(EngineError, match="it has to return its answer"):
        Engine(Tree(SENSE), lambda _: LeafBinding(sense, condition=True), clock=Clock())


def test_an_action_yields_no_end() -> None:
    closed = list[str]()

    def act() -> Iterator[int]:
        try:
            yield FAILURE
        finally:
            closed.append("act")

    engine = Engine(Tree(ACT), lambda _: LeafBinding(act), clock=Clock())
    assert (engine.tick(), closed) == (FAILURE, ["act"])
    assert engine.failure is not None
    assert engine.failure.reason == "it yielded False: to end, return that; a yield says that it runs"


def test_a_rule_whose_condition_was_never_known_is_listed_until_it_is() -> None:
    world = World()
    engine = world.engine(Node("Whenever", (SENSE, OTHER, SLEEP)))
    assert engine.tick() == RUNNING
    assert [failure.reason for failure in engine.unanswered] == ["the sensor is silent"]
    engine.halt()
    assert engine.tick() == RUNNING
    assert len(engine.unanswered) == 1
    world.knows = False
    assert engine.tick() == RUNNING
    assert engine.unanswered == []
    world.knows = None
    assert engine.tick() == RUNNING
    assert engine.unanswered == []

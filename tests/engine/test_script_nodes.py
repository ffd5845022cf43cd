"""The nodes Script and ScriptCondition, and leaves that write to the blackboard."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from btlang.engine.blackboard import Blackboard
from btlang.engine.engine import Engine
from btlang.engine.instance import EngineError
from btlang.engine.status import FAILURE, SKIPPED, SUCCESS
from btlang.tree.node import Node, Tree

from .scripted import World, n


def script(code: str) -> Node:
    return n("Script", code=code)


def check(code: str) -> Node:
    return n("ScriptCondition", code=code)


def reason(engine: Engine) -> str:
    """Why the tree fails."""
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    return engine.failure.reason


@pytest.mark.parametrize(
    ("code", "status", "why"),
    [
        ("1", SUCCESS, ""),
        ("-0.5", SUCCESS, ""),
        ("1/0", SUCCESS, ""),
        ("0", FAILURE, "this is not true: 0"),
        ("false; true", SUCCESS, ""),
        ("true; 2 > 3", FAILURE, "this is not true: true; 2 > 3"),
        ("'true'", FAILURE, "the text 'true' is neither true nor false"),
        ("gone", FAILURE, "{gone} has no value"),
    ],
)
def test_conditions(code: str, status: int, why: str) -> None:
    engine = World().engine(check(code))
    assert engine.tick() == status
    assert (engine.failure.reason if engine.failure else "") == why


def test_scripts_compute_over_ticks() -> None:
    world = World()
    count = n("Sequence", script("n += 1"), n("Inverter", check("n < 3")))
    engine = world.engine(n("Sequence", script("n := 0"), n("RetryUntilSuccessful", count, num_attempts="-1")))
    assert world.ticks(engine, 3) == "rrs"
    assert engine.blackboard.get("n") == 3


def test_a_script_that_cannot_go_on_fails_with_its_reason() -> None:
    assert (
        reason(World().engine(script("n := 1; n + 'a'"))) == "+ takes two numbers or two texts, not 1 and the text 'a'"
    )
    assert reason(World().engine(n("Sequence", script("0"), script("n += 1")))).startswith("{n} has no value")


def test_scripts_may_be_skipped() -> None:
    assert World().engine(n("Script", code="n := 1", _skipIf="true")).tick() == SKIPPED


@pytest.mark.parametrize("id", ["Script", "ScriptCondition"])
@pytest.mark.parametrize(
    ("ports", "message"),
    [
        ({}, "needs a port code"),
        ({"code": ""}, "needs a port code"),
        ({"code": "a :="}, "its code 'a :=' cannot be read: a value is missing at the end, at character 5"),
        ({"code": "{a}{b}"}, "its code '{a}{b}' cannot be read: '{' isn't valid in a script, at character 1"),
        ({"code": "1", "codes": "2"}, "takes no port codes"),
    ],
)
def test_code_that_cannot_be_read(id: str, ports: dict[str, str], message: str) -> None:
    with pytest.raises(EngineError) as raised:
        World().engine(n("Sequence", n(id, **ports)))
    assert raised.value.message.removeprefix(f"{id} ") == message
    assert raised.value.node.id == id


def test_code_may_come_from_the_blackboard() -> None:
    engine = World().engine(check("{rule}"))
    assert reason(engine) == "{rule} has no value"
    for rule, status in (("1 > 2", FAILURE), ("2 > 1", SUCCESS), (1, SUCCESS), ("2 > 1", SUCCESS)):
        engine.blackboard.set("rule", rule)
        assert engine.tick() == status
    engine.blackboard.set("rule", "2 >")
    assert reason(engine) == "{rule} holds no script: a value is missing at the end, at character 4"


def test_scripts_in_subtrees_read_and_write_through_ports() -> None:
    use = n("SubTree", ID="go", x="{x}", y="{made}", z="5", again="{x}")
    body = n(
        "Sequence", check("x == 1 && again == 1"), script("x += 1; y := z; own := 3; @n += 1"), check("again == 2")
    )
    tree = Tree(n("Sequence", script("x := 1; n := 0"), use, check("x == 2 && made == 5 && n == 1")), (("go", body),))
    engine = World().engine(tree)
    assert engine.tick() == SUCCESS
    assert engine.blackboard.keys() == ["x", "n", "made"]
    assert reason(World().engine(Tree(n("Sequence", use), (("go", body),)))) == "{x} has no value"


# Outputs of leaves


def _function(store: Callable[[float], None], scale: int) -> bool:
    store(2.5 * scale)
    return True


def _generator(store: Callable[[float], None], scale: int) -> Iterator[None]:
    store(0)
    yield
    store(2.5 * scale)


class _Class:
    def start(self, store: Callable[[float], None], scale: int) -> None:
        self.store, self.scale = store, scale
        store(0)

    def tick(self) -> bool:
        self.store(2.5 * self.scale)
        return True

    def halt(self) -> None: ...


@pytest.mark.parametrize(("call", "ticks"), [(_function, "s"), (_generator, "rs"), (_Class, "rs")])
@pytest.mark.parametrize("scale", ["2", "{scale}"])
def test_leaves_write_outputs(call: Any, ticks: str, scale: str) -> None:
    world = World()
    world.bind("A", call, outputs=("store",), converters={"scale": int, "store": int})
    blackboard = Blackboard()
    blackboard.set("scale", 2)
    engine = world.engine(n("A", store="{seen}", scale=scale), blackboard=blackboard)
    assert blackboard.keys() == ["scale"]
    assert world.ticks(engine, len(ticks)) == ticks
    assert blackboard.get("seen") == 5.0


def test_outputs_go_through_the_ports_of_subtrees() -> None:
    world = World()
    world.bind("A", _function, outputs=("store",), converters={"scale": int}, defaults={"store": "{=}", "scale": "4"})
    tree = Tree(n("SubTree", ID="go", store="{level}"), (("go", n("Sequence", n("A"), check("store == 10"))),))
    engine = world.engine(tree)
    assert engine.tick() == SUCCESS
    assert engine.blackboard.get("level") == 10


@pytest.mark.parametrize(
    ("ports", "message"),
    [
        ({"store": "seen", "scale": "1"}, "store is an output: it must be a {key}, not 'seen'"),
        ({"scale": "1"}, "A needs a value for store"),
    ],
)
def test_an_output_must_name_a_key(ports: dict[str, str], message: str) -> None:
    world = World()
    world.bind("A", _function, outputs=("store",))
    with pytest.raises(EngineError) as raised:
        world.engine(n("A", **ports))
    assert raised.value.message == message


def test_an_output_may_be_left_out_where_the_leaf_says_so() -> None:
    world = World()
    world.bind("A", lambda store=None: store is None, outputs=("store",))
    assert world.engine(n("A")).tick() == SUCCESS

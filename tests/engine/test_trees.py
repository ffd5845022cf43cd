"""Subtrees, blackboard scopes, paths, what a listener is told, and very deep trees."""

from __future__ import annotations

import pytest

from btlang.engine import compile as compiling
from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import EngineError
from btlang.engine.status import FAILURE, SUCCESS
from btlang.tree.node import Node, Tree
from tests.profiles import amount

from .scripted import LETTER, World, n


def test_each_use_of_a_subtree_is_an_instance_of_its_own() -> None:
    world = World()
    world.fn("A", "s")
    world.cls("B", "rs")
    use = n("SubTree", ID="go")
    tree = Tree(n("Parallel", use, use), (("go", n("Sequence", n("A"), n("B"))),))
    engine = world.engine(tree)
    assert [path for path, _ in engine.nodes] == [
        "/",
        "/0",
        "/0/0",
        "/0/0/0",
        "/0/0/1",
        "/1",
        "/1/0",
        "/1/0/0",
        "/1/0/1",
    ]
    assert [engine.path(i) for i in range(9)] == [path for path, _ in engine.nodes]
    assert engine.node(4).id == "B"
    engine.tick()
    assert world.log == ["A", "B.start", "A", "B.start"]


def test_a_subtree_sees_only_its_ports() -> None:
    seen: list[object] = []
    world = World()
    world.bind("See", lambda who, here: seen.append((who, here)), defaults={"here": "{place}"})
    world.bind("Put", lambda blackboard, key, value: blackboard.set(key, value))
    outer = n("SubTree", ID="outer", who="{name}", place="lab")
    inner = n("SubTree", ID="inner", person="{who}")
    tree = Tree(
        n("Sequence", n("Put", key="name", value="Ann"), outer, n("See", who="{back}", here="?")),
        (
            ("outer", n("Sequence", n("See", who="{who}"), inner, n("See", who="{who}"))),
            ("inner", n("Sequence", n("Put", key="person", value="Bob"), n("Put", key="back", value="lost"))),
        ),
    )  # fmt: skip
    engine = world.engine(tree)
    assert engine.tick() == FAILURE
    assert seen == [("Ann", "lab"), ("Bob", "lab")]
    assert engine.failure is not None
    assert engine.failure.reason == "{back} has no value"
    assert engine.blackboard.get("name") == "Bob"


def test_numbers_may_come_from_the_blackboard() -> None:
    world = World()
    body = n("Repeat", world.fn("A", "s"), num_cycles="{times}")
    for times, letters in (("2", "rs"), ("0", "s"), ("many", "f"), ("-7", "f")):
        tree = Tree(n("SubTree", ID="go", times=times), (("go", body),))
        assert world.ticks(world.engine(tree), len(letters)) == letters
    engine = world.engine(body)
    engine.tick()
    assert engine.failure is not None
    assert engine.failure.reason == "{times} has no value"
    assert engine.failure.node == body


def test_a_subtree_that_contains_itself() -> None:
    tree = Tree(n("SubTree", ID="a"), (("a", n("Inverter", n("SubTree", ID="b"))), ("b", n("SubTree", ID="a"))))
    with pytest.raises(EngineError, match="the subtree a contains itself"):
        World().engine(tree)


def test_a_tree_that_grows_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiling, "MOST_NODES", 100)
    levels = [(f"t{i}", n("Sequence", *[n("SubTree", ID=f"t{i + 1}")] * 2)) for i in range(50)]
    with pytest.raises(EngineError, match="the tree has more than 100 nodes"):
        World().engine(Tree(n("SubTree", ID="t0"), (*levels, ("t50", n("AlwaysSuccess")))))


def test_autoremap_shares_all_but_private_keys_and_ports() -> None:
    body = n(
        "Sequence",
        n("ScriptCondition", code="x == 1 && port == 'here' && other == 1"),
        n("Script", code="x := 2; made := 3; _own := 4; port := 'there'; @top := 5"),
        n("SubTree", ID="inner", _autoremap="1"),
    )
    inner = n("Sequence", n("ScriptCondition", code="made == 3 && port == 'there'"), n("Script", code="made += 1"))
    use = n("SubTree", ID="outer", _autoremap="true", port="here", other="{x}")
    tree = Tree(n("Sequence", n("Script", code="x := 1; port := 'up'"), use), (("outer", body), ("inner", inner)))
    engine = World().engine(tree)
    assert engine.tick() == SUCCESS
    seen = engine.blackboard
    assert {key: seen.get(key) for key in seen.keys()} == {"x": 2, "port": "up", "made": 4, "top": 5}  # noqa: SIM118


def test_spaces_around_a_key_do_not_count() -> None:
    body = n("Script", code="there := there + ' it is'")
    use = n("Sequence", n("Script", code="here := 'well,'"), n("SubTree", ID="a", there=" {here}  "))
    world = World()
    engine = world.engine(Tree(use, (("a", body),)))
    assert engine.tick() == SUCCESS
    assert engine.blackboard.get("here") == "well, it is"


def test_without_autoremap_nothing_is_shared() -> None:
    body = n("Script", code="x := 2")
    for ports in ({}, {"_autoremap": "false"}):
        engine = World().engine(Tree(n("SubTree", ID="a", **ports), (("a", body),)))
        assert engine.tick() == SUCCESS
        assert engine.blackboard.keys() == []
    with pytest.raises(EngineError, match="_autoremap must be true or false, not 'yes'"):
        World().engine(Tree(n("SubTree", ID="a", _autoremap="yes"), (("a", body),)))


def test_a_scope_tells_the_keys_that_it_shares() -> None:
    above = Blackboard()
    above.set("x", 1)
    above.set("_private", 2)
    below = Blackboard({"y": (above, "x"), "z": (above, "gone")}, above, shares=True, values={"port": "3"})
    assert below.keys() == ["port", "y", "x"]
    below.unset("x")
    assert above.keys() == ["_private"]


# What a listener is told


def told(root: Node, world: World, ticks: int) -> list[str]:
    """One word for each tick: index and letter of each change, as in `2r0r`."""
    engine = world.engine(root, watched=True)
    words = []
    for _ in range(ticks):
        engine.tick()
        words.append("".join(f"{index}{LETTER.get(status, 'i')}" for index, status in world.changes))
        world.changes.clear()
    return words


def test_polled_conditions_are_told_once() -> None:
    world = World()
    root = n("ReactiveSequence", n("Fallback", world.fn("A", "f"), world.fn("B", "sssf")), world.cls("C", "r"))
    assert told(root, world, 4) == ["2f3s1s4r0r", "", "", "3f1f4i0f"]


def test_actions_in_a_loop_are_told_each_time() -> None:
    world = World()
    assert told(n("Repeat", world.cls("A", "s"), num_cycles=3), world, 3) == ["1r1s0r", "1r1s", "1r1s0s"]
    assert told(n("Repeat", world.fn("A", "s"), num_cycles=3), world, 3) == ["1s0r", "1s", "1s0s"]
    body = n("Sequence", world.fn("A", "s"), world.gen("B", "rs"))
    assert told(n("Repeat", body, num_cycles=-1), world, 3) == ["2s3r1r0r", "3s1s2s3r1r", "3s1s2s3r1r"]


def test_a_condition_that_is_waited_for_is_told_once() -> None:
    world = World()
    assert told(n("RetryUntilSuccessful", world.fn("A", "fffs"), num_attempts=-1), world, 4) == ["1f0r", "", "", "1s0s"]


def test_a_round_that_lasts_after_one_within_a_tick_is_told_whole() -> None:
    world = World()
    attempt = n("Sequence", world.fn("A", "s"), world.cls("B", "frs"), world.fn("C", "s"))
    assert told(n("RetryUntilSuccessful", attempt, num_attempts=-1), world, 3) == ["2s3r3f1f0r", "3r2s1r", "3s4s1s0s"]


def test_what_a_lasting_round_has_not_reached_is_told_when_it_is() -> None:
    world = World()
    attempt = n("Fallback", world.cls("A", "frff"), n("Inverter", world.fn("B", "s")))
    root = n("RetryUntilSuccessful", attempt, num_attempts=-1)
    assert told(root, world, 3) == ["2r2f4s3f1f0r", "2r1r", "2f4s3f1f2r2f4s3f"]


@pytest.mark.long
def test_a_deep_tree_that_lasts_after_a_round_within_a_tick() -> None:
    world = World()
    root = world.fn("A", "sr")
    depth = amount(2_000, 10_000)  # it takes time of its square; even, as the levels turn the status
    for _ in range(depth):
        root = n("Inverter", root)
    words = told(n("RetryUntilSuccessful", n("Inverter", root), num_attempts=-1), world, 2)
    assert [len(word.split("r")) for word in words] == [2, depth + 3]


def test_an_interrupted_action_is_told_before_the_one_that_replaces_it() -> None:
    world = World()
    first = n("Sequence", world.fn("C", "fs"), world.cls("A", "r"))
    root = n("ReactiveFallback", first, world.cls("B", "r"))
    assert told(root, world, 2) == ["2f1f4r0r", "2s4i3r1r"]

"""Regions that are generated in place of closures: when, what their code may hold, what is shared, how deep they are.

That they do the same is tested by all other tests of the engine, each of which runs with them as well.
"""

from __future__ import annotations

import io
import keyword
import pkgutil
import tokenize
from collections.abc import Iterator
from unittest.mock import patch

import pytest

from btlang.engine import generation, regions
from btlang.engine.engine import Engine
from btlang.engine.nodes.templates import NAMES, TEMPLATES
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node
from tests.profiles import amount

from .scripted import World, n

VERY_DEEP = amount(10_000, 30_000)

ATTRIBUTES = {
    *("fault", "unknown", "unknowns", "interrupts", "append", "pop"),
    *("send", "tick", "yielded", "ended", "answered", "passed", "decided", "complete", "reached", "wait", "halt"),
}

PORTS = {"Repeat": {"num_cycles": 2}, "RetryUntilSuccessful": {"num_attempts": 2}, "Timeout": {"msec": 1000}}


@pytest.fixture
def made() -> Iterator[dict[str, object]]:
    """The shapes of the regions that are generated, by their code."""
    with patch.dict(regions._shapes, clear=True):
        yield regions._shapes  # type: ignore[misc]


def generated(world: World, root: Node, watched: bool = False) -> Engine:
    """An engine with regions."""
    with patch.object(generation, "TICKS_BEFORE", 0):
        return world.engine(root, watched)


def all_templates(world: World, id: str = "A") -> Node:
    """A tree that has each template."""
    leaves = [world.fn(id, "s"), world.cls(f"{id}c", "rs"), world.gen(f"{id}g", "rs")]
    root = n("Sequence", *leaves, *[world.fn(id, "s")] * 40, n("Parallel", *[leaves[1]] * 16, *[leaves[2]] * 16))
    for template in sorted(TEMPLATES):
        if template != "SubTree":
            most = CATALOGUE[template].most
            root = n(template, *leaves[: most - 1], root, **PORTS.get(template, {}))
    return root


@pytest.mark.parametrize("watched", [False, True])
def test_code_holds_nothing_of_the_tree(made: dict[str, object], watched: bool) -> None:
    world = World()
    root = all_templates(world, "boom'); import os\nos._exit(1) #\"")
    generated(world, root.replace(name="boom", ports=(("_boom", "boom"),)), watched).tick()
    assert made
    for code in made:
        assert "boom" not in code
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            assert token.type != tokenize.STRING
            if token.type == tokenize.NAME and not keyword.iskeyword(token.string):
                known = token.string in NAMES or token.string in ATTRIBUTES
                assert known or token.string.rstrip("0123456789") in set("SLWefghkpqrtuwxz"), token.string
    assert NAMES["__builtins__"] == {}


def test_equal_trees_share_their_code(made: dict[str, object]) -> None:
    world = World()
    generated(world, all_templates(world))
    shapes = len(made)
    generated(world, all_templates(world, "B"))
    assert len(made) == shapes


@pytest.mark.parametrize("watched", [False, True])
def test_what_runs_goes_on_behind_the_exchange(made: dict[str, object], watched: bool) -> None:
    world = World()
    running = n(
        "Parallel",
        world.cls("A", "rrrrs"),
        world.gen("B", "rrrrs"),
        n("Sequence", world.fn("C", "s"), n("Sleep", msec=4000)),
    )
    root = n("Repeat", n("Sequence", n("RunOnce", world.fn("D", "s")), running), num_cycles=2)
    with patch.object(generation, "TICKS_BEFORE", 2):
        engine = world.engine(root, watched)
    for _ in range(4):
        assert engine.tick() == RUNNING
        world.clock.advance(1)
    assert engine.tick() == RUNNING
    assert made
    starts, goes_on = ["A.start", "B.start"], ["A.tick", "B.tick"]
    assert [each for each in world.log if each != "C"] == ["D", *starts, *goes_on * 4, *starts]  # and the second round


def test_it_is_generated_in_steps_once_it_was_ticked_often(made: dict[str, object]) -> None:
    world = World()
    rounds = [n("ReactiveSequence", *[world.fn("A", "s")] * (2 + number)) for number in range(5)]
    root = n("ParallelAll", world.fn("B", "s"), n("ParallelAll", *rounds[:3]), n("ParallelAll", *rounds[2:]))
    with patch.object(generation, "TICKS_BEFORE", 3):
        engine = world.engine(root)
    counts = []
    for _ in range(10):
        assert engine.tick() == SUCCESS
        counts.append(len(made))
    assert counts == [0, 0, 0, 1, 2, 3, 4, 5, 5, 5]


def test_a_very_large_tree_and_one_with_hooks_are_not_generated(made: dict[str, object]) -> None:
    class Hooks:
        def wrap(self, index: int, compiled: object) -> object:
            return compiled

    world = World()
    root = n("Sequence", world.fn("A", "s"), world.fn("B", "s"))
    with patch.object(generation, "TICKS_BEFORE", 0):
        assert world.engine(root, hooks=Hooks()).tick() == SUCCESS
        with patch.object(generation, "MOST_NODES", 2):
            assert world.engine(root).tick() == SUCCESS
    assert not made


@pytest.mark.parametrize("interrupted", ["regions.make_region", "generation.Generated.take_over"])
def test_ctrl_c_while_it_is_generated_leaves_one_or_the_other(interrupted: str) -> None:
    world = World()
    root = n("RunOnce", n("Sequence", world.fn("A", "s"), world.cls("B", "rrrrs")), then_skip="false")
    with patch.object(generation, "TICKS_BEFORE", 1):
        engine = world.engine(root)
    engine.tick()
    target = f"btlang.engine.{interrupted}"
    module, _, name = target.rpartition(".")
    usual = pkgutil.resolve_name(target)

    def interrupt(*arguments: object) -> object:
        setattr(pkgutil.resolve_name(module), name, usual)
        raise KeyboardInterrupt

    with patch(target, interrupt), pytest.raises(KeyboardInterrupt):
        world.ticks(engine, 4)
    assert world.log[-1] == "B.halt"
    assert world.ticks(engine, 6).lstrip("r").strip("s") == ""
    assert engine.save()["nodes"]["0"][0]["result"] is True


@pytest.mark.long
@pytest.mark.parametrize("watched", [False, True])
@pytest.mark.parametrize(
    ("around", "depth"),
    [
        ("Sequence Inverter Fallback Inverter", VERY_DEEP),
        ("ReactiveFallback Parallel ReactiveSequence Sequence", 1_000),
        ("IfThenElse WhileDoElse Repeat Timeout", 1_000),
    ],
)
def test_depth_does_not_matter(around: str, depth: int, watched: bool) -> None:
    world = World()
    root = n("Fallback", world.fn("A", "f"), world.gen("B", "rf"))
    ids = around.split()
    for level in range(depth):
        id = ids[level % len(ids)]
        root = n(id, *[n("AlwaysSuccess")] * (CATALOGUE[id].least - 1), root, **PORTS.get(id, {}))
    with patch.object(generation, "MOST_NODES", 100_000):
        engine = generated(world, root, watched)
    assert engine.tick() == RUNNING
    assert engine.tick() == FAILURE
    engine.tick()
    engine.halt()
    assert world.log == ["A", "B.start", "B.tick", "A", "B.start", "B.halt"]


@pytest.mark.long
def test_a_region_for_each_of_many_levels_is_ticked_and_halted() -> None:
    world = World()
    root = world.cls("A", "r")
    for level in range(VERY_DEEP):
        root = n(("Sequence", "Sequence", "Parallel")[level % 3], root)
    with patch.object(generation, "MOST_NODES", 100_000):
        engine = generated(world, root)
    assert engine.tick() == RUNNING
    engine.suspend()
    engine.halt()
    assert world.log == ["A.start", "A.halt"]


def test_a_slot_is_the_cell_of_a_closure_for_what_is_saved() -> None:
    """What is saved by one engine has all that the other one needs, by the same names."""
    world = World()
    root = n("Sequence", world.fn("A", "s"), n("Parallel", world.fn("B", "s"), world.gen("C", "r")))
    saved = []
    for engine in (world.engine(root), generated(world, root)):
        engine.tick()
        saved.append(engine.save()["nodes"])
    assert saved[0] == saved[1] == {"0": [{"index": 1, "skipped": 0}], "2": [{"completed": {"list": [True, False]}}]}

"""A resumed tick goes straight to what is RUNNING, however many nodes above only wait for it."""

from __future__ import annotations

import sys

import pytest

from btlang.engine.engine import Engine
from btlang.engine.status import RUNNING
from btlang.tree.node import Node

from .scripted import World, n

WAITING = ("Sequence", "Fallback", "AsyncSequence", "Inverter", "ForceSuccess", "Repeat", "RetryUntilSuccessful")
PORTS = {"Repeat": {"num_cycles": 3}, "RetryUntilSuccessful": {"num_attempts": 3}}


def calls_of_a_tick(engine: Engine) -> int:
    """How many Python functions one tick calls."""
    calls = 0

    def count(frame: object, event: str, argument: object) -> None:
        nonlocal calls
        calls += event == "call"

    sys.setprofile(count)
    try:
        engine.tick()
    finally:
        sys.setprofile(None)
    return calls


def below(depth: int, leaf: Node, around: str = "") -> Node:
    """A leaf below so many nodes that wait, with another node half way down where one is asked for."""
    root = leaf
    for level in range(depth):
        id = WAITING[level % len(WAITING)]
        if around and level == depth // 2:
            root = n(around, root)
        root = n(id, root, **PORTS.get(id, {}))
    return root


@pytest.mark.parametrize("around", ["", "ReactiveSequence", "Parallel"])
@pytest.mark.parametrize("watched", [False, True])
def test_a_resumed_tick_does_not_depend_on_depth(around: str, watched: bool) -> None:
    counts = []
    for depth in (200, 400):
        world = World()
        engine = world.engine(below(depth, world.gen("A", "r"), around), watched)
        assert engine.tick() == RUNNING
        counts.append(calls_of_a_tick(engine))
        assert world.since() == ["A.start", "A.tick"]
    assert counts[0] == counts[1]


def test_what_was_resumed_completes_once() -> None:
    world = World()
    engine = world.engine(n("Sequence", n("Sequence", n("Sequence", world.cls("A", "rrs"), world.cls("B", "rf")))))
    assert world.ticks(engine, 4) == "rrrf"
    assert world.since() == ["A.start", "A.tick", "A.tick", "B.start", "B.tick"]


def test_a_halt_forgets_what_was_resumed() -> None:
    world = World()
    engine = world.engine(below(21, world.cls("A", "r")))
    world.ticks(engine, 2)
    for stop in (engine.halt, engine.suspend):
        stop()
        world.ticks(engine, 2)
    assert world.since() == ["A.start", "A.tick", *["A.halt", "A.start", "A.tick"] * 2]


def test_a_pre_condition_on_the_way_is_asked_at_each_tick() -> None:
    world = World()
    guard = n("Sequence", n("Sequence", n("Sequence", world.cls("A", "r"))), _while="go == 1")
    engine = world.engine(n("Sequence", n("Sequence", n("Fallback", guard))))
    engine.blackboard.set("go", 1)
    world.ticks(engine, 2)
    engine.blackboard.set("go", 0)
    engine.tick()
    assert world.since() == ["A.start", "A.tick", "A.halt"]

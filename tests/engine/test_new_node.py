"""A control node takes two entries: its data in the catalogue, and its function among the semantics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import pytest

import btlang
from btlang.engine.compile import SEMANTICS
from btlang.engine.instance import NodeInstance, split_children
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE, MOST_NODES, NodeKind, Port

from .scripted import World, n

if TYPE_CHECKING:
    from btlang.engine.instance import Compiled

MAJORITY = NodeKind("Majority", "Control", 1, MOST_NODES, ports={"needed": Port("int", "1", 1)}, at_once=True)

XML = """
<root BTCPP_format="4" main_tree_to_execute="M">
  <BehaviorTree ID="M"><Majority needed="1"><Nod/><Wave/></Majority></BehaviorTree>
</root>
"""


def majority(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Ticks all children; SUCCESS if at least `needed` of them succeed in the same tick."""
    ticks, halts = split_children(children)
    needed = instance.number("needed", most=len(ticks))

    def tick() -> int:
        statuses = [child() for child in ticks]
        if RUNNING in statuses:
            return RUNNING
        return SUCCESS if statuses.count(SUCCESS) >= needed() else instance.fail("too few children succeeded")

    def halt(keep: bool) -> None:
        for stop in halts:
            stop(keep)

    return tick, halt


@pytest.fixture(autouse=True)
def known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CATALOGUE, MAJORITY.id, MAJORITY)  # type: ignore[arg-type]
    monkeypatch.setitem(SEMANTICS, MAJORITY.id, majority)


def test_the_engine_runs_it_with_leaves_of_every_kind() -> None:
    world = World()
    children = world.fn("A", "sf"), world.gen("B", "rss"), world.cls("C", "fff"), world.fn("D", "xx")
    assert world.ticks(world.engine(n("Majority", *children, needed=2)), 3) == "rfs"


def test_a_failure_says_why_and_ports_are_checked() -> None:
    world = World()
    engine = world.engine(n("Majority", world.fn("A", "s"), world.fn("B", "f"), needed=2))
    assert engine.tick() == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "too few children succeeded"
    with pytest.raises(btlang.MissionError, match="needed must be"):
        btlang.parse_tree(XML.replace('needed="1"', 'needed="0"')).run()


def test_xml_english_and_drawings_know_it() -> None:
    mission = btlang.parse_tree(XML)
    assert mission.run(speed="max").succeeded
    assert '<Majority needed="1">' in mission.to("xml")
    english = mission.to("english")
    assert "majority" in english.lower()
    assert btlang.parse_tree(english).tree == mission.tree
    assert "Majority" in mission.to("dot")

"""Things described by what is in them, or by a part of them: `the glass of water`, `the cup with a red lid`."""

from __future__ import annotations

import pytest

import btlang
from btlang.engine.status import FAILURE, SUCCESS
from btlang.frontends.mission.reader import PARSERS

WORLD = """
start = { x = 1, y = 1 }
places = [{ name = "kitchen", kind = "room", x = 3, y = 8 }, { name = "table", x = 4, y = 7 }]
people = [{ name = "Alice", x = 10, y = 5 }]
objects = [
  { name = "glass 1", kind = "glass", content = "water", x = 4.4, y = 7.2 },
  { name = "glass 2", kind = "glass", content = "orange juice", x = 2.4, y = 7.2 },
  { name = "cup 1", kind = "cup", has = ["red lid"], x = 8, y = 2 },
  { name = "cup 2", kind = "cup", color = "blue", has = ["lid", "handle"], x = 9, y = 2 },
  { name = "bottle of beer", x = 8, y = 4 },
]
"""


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("pick up the glass of water", {"kind": "glass", "content": "water"}),
        ("pick up a glass filled with orange juice", {"kind": "glass", "content": "orange juice"}),
        ("pick up the cup with a red lid", {"kind": "cup", "part": "red lid"}),
        ("pick up the blue cup that has a lid", {"kind": "cup", "part": "lid", "color": "blue"}),
        ("pick up the glass of water near the table", {"kind": "glass", "content": "water", "near": "table"}),
    ],
)
def test_what_is_described(said: str, meant: dict[str, str], world: str) -> None:
    trees = [btlang.parse_tree(said, world=world, parser=parser) for parser in PARSERS]
    assert trees[0].tree == trees[1].tree
    chosen = dict(trees[0].tree.root.children[0].ports)
    assert {name: chosen[name] for name in chosen if name not in ("how", "output", "type")} == meant
    for form in ("xml", "json", "english"):
        assert btlang.parse_tree(str(trees[0].to(form)), world=world).tree == trees[0].tree


def test_a_name_of_the_world_comes_first(world: str) -> None:
    [node] = [btlang.parse_tree("pick up the bottle of beer", world=world).tree.root]
    assert dict(node.ports) == {"object": "bottle of beer"}


def test_sets(world: str) -> None:
    root = btlang.parse_tree("pick up all cups with a lid", world=world).tree.root
    assert [dict(node.ports)["object"] for node in root.children] == ["cup 1", "cup 2"]


@pytest.mark.parametrize("said", ["pick up the glass of wine", "pick up the cup with a spoon"])
def test_what_the_world_does_not_have_is_an_error(said: str, world: str) -> None:
    with pytest.raises(btlang.MissionError):
        btlang.parse_tree(said, world=world)


def test_it_is_chosen_when_the_command_starts(world: str) -> None:
    ended = btlang.parse_tree("pick up the glass of orange juice", world=world).run(speed="max")
    assert ended.status == SUCCESS
    failed = btlang.parse_tree("pick up the cup of orange juice", world=world).run(speed="max")
    assert failed.status == FAILURE
    assert failed.failure is not None
    assert failed.failure.reason == "I haven't seen a cup of orange juice"
    failed = btlang.parse_tree("pick up the blue cup with a red lid", world=world).run(speed="max")
    assert failed.failure is not None
    assert failed.failure.reason == "I haven't seen a blue cup with a red lid"

"""Nouns with parts (`[[noun]]`): they stand in the place of a slot, and their parts become ports."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.errors import MissionError

PACK = """
[[noun]]
type = "person"
phrase = "person wearing [a] {color} {clothing}"
slots = { clothing = "text" }

[[noun]]
type = "object"
phrase = "{color} thing on {place}"

[[type]]
name = "color"
values = ["red", "blue"]

[[action]]
phrase = ["escort {person} [to {place}]", "show {place} to {person}"]
id = "Escort"

[[action]]
phrase = "wrap {object} for {guest}"
id = "Wrap"
slots = { guest = "person" }

[[condition]]
phrase = "{person} is/are tired"
id = "IsTired"
"""


@pytest.fixture(name="pack")
def _pack(tmp_path: Path) -> str:
    path = tmp_path / "host.toml"
    path.write_text(PACK, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    ("text", "ports"),
    [
        ("escort Alice to the lobby", {"person": "Alice", "place": "lobby"}),
        ("escort the person wearing a red hat", {"color": "red", "clothing": "hat"}),
        ("escort the person wearing a blue coat to the lab", {"color": "blue", "clothing": "coat", "place": "lab"}),
        ("show the lab to the person wearing red shoes", {"place": "lab", "color": "red", "clothing": "shoes"}),
        ("wrap the red thing on the dock for Bob", {"color": "red", "place": "dock", "guest": "Bob"}),
    ],
)
def test_parts_are_ports(text: str, ports: dict[str, str], pack: str) -> None:
    root = parse_tree(text, keywords=[pack]).tree.root
    assert dict(root.ports) == ports
    assert parse_tree(text, keywords=[pack], parser="lark").tree.root == root


def test_the_noun_is_said_where_the_tree_is_read_back(pack: str) -> None:
    mission = parse_tree("if bumped, escort the person wearing a red hat to the lab", keywords=[pack])
    back = parse_tree(str(mission.to("xml")), keywords=[pack])
    assert "escort person wearing red hat to lab" in str(back.to("english"))
    assert parse_tree(str(back.to("english")), keywords=[pack]).tree.root == mission.tree.root


def test_it_also_stands_in_conditions(pack: str) -> None:
    mission = parse_tree("if the person wearing a red hat is tired, wave", keywords=[pack])
    assert dict(mission.tree.root.children[0].ports) == {"color": "red", "clothing": "hat"}


def test_a_wrong_part_is_asked_for(pack: str) -> None:
    with pytest.raises(MissionError, match="no color called 'striped hat'"):
        parse_tree("escort the person wearing a striped hat", keywords=[pack])

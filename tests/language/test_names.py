"""Names with a letter at their end, names behind the kind of thing they are, and nouns that several things share."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.frontends.mission.reader import PARSERS

WORLD = """
start = { x = 1, y = 1 }
places = [
  { name = "shelf A", x = 3, y = 8 }, { name = "shelf B", x = 4, y = 7 },
  { name = "Carl's room", kind = "room", x = 5, y = 7 }, { name = "store room", kind = "room", x = 6, y = 7 },
]
people = [{ name = "Amira", kind = "nurse", x = 10, y = 5 }, { name = "Carl", kind = "guest", x = 10, y = 6 }]
objects = [{ name = "cup 1", kind = "cup", x = 8, y = 2 }]
doors = [
  { name = "front door", from = [0, 1], to = [0, 2] },
  { name = "back door", from = [0, 4], to = [0, 5] },
]
"""


@pytest.mark.parametrize(
    ("said", "id", "ports"),
    [
        ("go to shelf A", "GoTo", {"place": "shelf A"}),
        ("go to shelf a, please", "GoTo", {"place": "shelf A"}),
        ("Go to the shelf B", "GoTo", {"place": "shelf B"}),
        ("go to nurse Amira", "GoToPerson", {"person": "Amira"}),
        ("tell nurse Amira that the door is open", "TellPerson", {"person": "Amira", "text": "the door is open"}),
    ],
)
def test_the_whole_name_is_read(said: str, id: str, ports: dict[str, str], world: str) -> None:
    trees = [btlang.parse_tree(said, world=world, parser=parser) for parser in PARSERS]
    assert trees[0].tree == trees[1].tree
    assert (trees[0].tree.root.id, dict(trees[0].tree.root.ports)) == (id, ports)
    for form in ("xml", "json", "english"):
        assert btlang.parse_tree(str(trees[0].to(form)), world=world).tree == trees[0].tree


def test_whose_room_is_meant(world: str) -> None:
    tree = btlang.parse_tree("guide Carl to shelf B, then guide him to his room", world=world)
    assert [dict(node.ports)["place"] for node in tree.tree.root.children] == ["shelf B", "Carl's room"]
    assert [warning.code for warning in tree.warnings] == []


def test_an_article_behind_a_kind_begins_a_clause(world: str) -> None:
    tree = btlang.parse_tree("tell a nurse Amira is ill", world=world).tree
    assert [dict(node.ports).get("text") for node in tree.walk() if node.id == "TellPerson"] == ["Amira is ill"]


def test_a_letter_is_no_kind(world: str) -> None:
    with pytest.raises(btlang.MissionError) as refused:
        btlang.parse_tree("count the bs", world=world)
    assert refused.value.diagnostics[0].code == "BT013"


def test_one_of_several_doors_must_be_named(world: str) -> None:
    for said in ("close the door", "pick up the cup and close the door"):
        with pytest.raises(btlang.MissionError) as refused:
            btlang.parse_tree(said, world=world)
        assert refused.value.diagnostics[0].code == "BT013"


FAMILY = """
start = { x = 1, y = 1 }
people = [
  { name = "Mr Keller", x = 6, y = 7 }, { name = "Mrs Keller", x = 7, y = 7 }, { name = "Dr Weber", x = 3, y = 3 },
]
"""


@pytest.mark.parametrize("text", [FAMILY, FAMILY.replace("Mr ", "Mr. ").replace("Mrs ", "Mrs. ")])
def test_titles_tell_people_apart(text: str, tmp_path: Path) -> None:
    world = str(tmp_path / "family.toml")
    Path(world).write_text(text, encoding="utf-8")
    said = "greet Weber, then greet Mrs. Keller, greet Mr Keller and greet Dr Weber"
    trees = [btlang.parse_tree(said, world=world, parser=parser) for parser in PARSERS]
    met = [dict(node.ports)["person"].replace(".", "") for node in trees[0].tree.walk() if node.ports]
    assert met == ["Dr Weber", "Mrs Keller", "Mr Keller", "Dr Weber"]
    assert trees[0].tree == trees[1].tree
    for form in ("xml", "json", "english"):
        assert btlang.parse_tree(str(trees[0].to(form)), world=world).tree == trees[0].tree


def test_a_family_name_alone_is_refused_where_titles_tell_people_apart(tmp_path: Path) -> None:
    world = str(tmp_path / "family.toml")
    Path(world).write_text(FAMILY, encoding="utf-8")
    with pytest.raises(btlang.MissionError, match="Similar: Mr Keller, Mrs Keller"):
        btlang.parse_tree("greet Keller", world=world)


DOORS = """
start = { x = 1, y = 1 }
places = [{ name = "back door", x = 3, y = 0.5 }, { name = "cold room", x = 3, y = 3 }]
doors = [
  { name = "cold room door", from = [2, 2], to = [3, 2] }, { name = "shop door", from = [5, 2], to = [6, 2] },
]
"""


def test_one_door_is_never_all_of_them(tmp_path: Path) -> None:
    world = str(tmp_path / "doors.toml")
    Path(world).write_text(DOORS, encoding="utf-8")
    for said in ("close the door", "open a door", "go to the back door and close the door"):
        with pytest.raises(btlang.MissionError, match="BT013"):
            btlang.parse_tree(said, world=world)
    doors = [
        [node.port("door") for node in btlang.parse_tree(said, world=world).tree.walk() if node.port("door")]
        for said in ("close the doors", "go to the cold room and close the door")
    ]
    assert doors == [["cold room door", "shop door"], ["cold room door"]]


AREAS = """
start = { x = 1, y = 1 }
places = [
  { name = "kitchen", x = 1, y = 1, points = [[0, 0], [2, 0], [2, 2], [0, 2]] },
  { name = "boiler room", x = 4, y = 1, points = [[3, 0], [5, 0], [5, 2], [3, 2]] },
]
"""


def test_every_room_is_refused_where_only_some_names_say_that_they_are_rooms(tmp_path: Path) -> None:
    world = str(tmp_path / "areas.toml")
    Path(world).write_text(AREAS, encoding="utf-8")
    with pytest.raises(btlang.MissionError, match="doesn't say whether 'kitchen' is one"):
        btlang.parse_tree("visit every room", world=world)
    Path(world).write_text(AREAS.replace('name = "kitchen"', 'name = "kitchen", kind = "room"'), encoding="utf-8")
    tree = btlang.parse_tree("visit every room", world=world).tree
    assert [node.port("place") for node in tree.walk() if node.port("place")] == ["kitchen", "boiler room"]

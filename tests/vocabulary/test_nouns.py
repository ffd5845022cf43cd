"""Nouns with parts (`[[noun]]`): they stand in the place of a slot, and their parts become ports."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.run.events import Chosen, Event
from btlang.text.source import Source

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


@pytest.fixture(name="pack", scope="module")
def _pack(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("pack") / "host.toml"
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


KNOWN = """
start = { x = 1, y = 1 }
walls = [[[0, 0], [8, 0], [8, 5], [0, 5], [0, 0]]]
places = [{ name = "lab", x = 6, y = 4 }]
objects = [
  { name = "near cup", x = 3, y = 2, kind = "cup", color = "red" },
  { name = "far cup", x = 6, y = 2, kind = "cup", color = "red", uses = ["drink"] },
  { name = "bottle", x = 4, y = 3, kind = "bottle", color = "green", size = 0.4, uses = ["drink"] },
  { name = "red box", x = 2, y = 4, kind = "box", color = "grey", size = 0.4 },
  { name = "crate", x = 3, y = 4.5, kind = "box", color = "red", size = 0.6 },
]
people = [
  { name = "Vera", x = 2, y = 2.5, wears = ["red coat", "hat"] },
  { name = "Tom", x = 6, y = 1, wears = ["blue hat"], gesture = "raising a hand" },
]
"""
WORLD = Source(KNOWN, "known.toml")


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("the red cup", "near cup"),
        ("a cup", "near cup"),
        ("the nearest thing to drink", "bottle"),
        ("something to drink", "bottle"),
        ("the green thing", "bottle"),
        ("something green", "bottle"),
        ("the biggest box", "crate"),
        ("the smallest box", "red box"),
        ("the biggest object", "crate"),
        ("the gray box", "red box"),
        ("the largest red box", "crate"),
        ("someone", "Vera"),
        ("a visitor", "Vera"),
        ("a person", "Vera"),
        ("the person in the red coat", "Vera"),
        ("the person wearing a blue hat", "Tom"),
        ("anybody in blue", "Tom"),
        ("the person with a coat", "Vera"),
        ("the person who is raising a hand", "Tom"),
        ("somebody who is raising a hand", "Tom"),
    ],
)
def test_a_description_is_chosen_when_the_command_starts(words: str, name: str) -> None:
    mission = parse_tree(f"go to {words}", world=WORLD)
    assert parse_tree(f"go to {words}", world=WORLD, parser="lark").tree == mission.tree
    xml = str(mission.to("xml"))
    back = parse_tree(xml, world=WORLD)
    assert str(back.to("xml")) == xml
    assert str(parse_tree(str(back.to("english")), world=WORLD).to("xml")) == xml
    events: list[Event] = []
    assert mission.run(speed="max", sinks=[events.append]).succeeded
    assert [event.name for event in events if isinstance(event, Chosen)] == [name]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("go to the red cup then look at it", "look at {object}"),
        ("approach the red cup and the green thing", "approach red cup\napproach green thing"),
        ("approach all red cups", "approach near cup\napproach far cup"),
        ("approach every cup except the red cup and the bottle", ""),
        ("for each gray box: approach it", "red box"),
        ("go to the lab then go to a person then wave at the person", "wave at {person}"),
        ("if the distance to the red cup is below 3 m, wave", "distance to red cup"),
    ],
)
def test_descriptions_in_sentences(text: str, said: str) -> None:
    if not said:
        with pytest.raises(MissionError, match="leaves out every object"):
            parse_tree(text, world=WORLD)
        return
    mission = parse_tree(text, world=WORLD)
    assert parse_tree(text, world=WORLD, parser="lark").tree == mission.tree
    english = str(mission.to("english"))
    assert said in english
    assert parse_tree(english, world=WORLD).tree.root == mission.tree.root


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("go to the purple cup", "I haven't seen a purple cup"),
        ("approach the orange thing", "I haven't seen anything orange"),
        ("approach all purple boxes", "I haven't seen a purple box"),
        ("approach the gray thing to drink", "I haven't seen anything gray to drink"),
        ("wave at the person in the green hat", "I don't see anybody in a green hat"),
    ],
)
def test_what_the_robot_does_not_know(text: str, reason: str) -> None:
    outcome = parse_tree(text, world=WORLD).run(speed="max")
    assert not outcome.succeeded
    assert reason in outcome.why()


def test_a_name_wins() -> None:
    assert parse_tree("approach the red box", world=WORLD).tree.root.port("object") == "red box"


def test_only_what_was_seen_counts() -> None:
    unknown = Source(
        "known = false\n" + KNOWN.replace("start = { x = 1, y = 1 }", "start = { x = 7.5, y = 4.5 }"), "w.toml"
    )
    wall = unknown.text.replace("[0, 0]]]", "[0, 0]], [[5, 0], [5, 5]]]", 1)
    outcome = parse_tree("look at the green thing", world=Source(wall, "w.toml")).run(speed="max")
    assert "I haven't seen anything green" in outcome.why()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("go to the purple elephant", "called 'purple elephant'"),
        ("go to the red cuup", "Did you mean: go to the red cup"),
    ],
)
def test_unknown_nouns_are_told(text: str, message: str) -> None:
    with pytest.raises(MissionError, match=message):
        parse_tree(text, world=WORLD)


def test_a_pack_declares_nouns_for_all_commands(tmp_path: Path) -> None:
    path = tmp_path / "guests.toml"
    path.write_text('[[noun]]\ntype = "person"\nhow = "seen"\nphrase = ["guest", "guest in [{color}] {clothing}"]\n')
    mission = parse_tree("wave at the guest in the blue hat", world=WORLD, keywords=[str(path)])
    assert dict(mission.tree.root.children[0].ports) == {
        "type": "person", "how": "seen", "output": "{person}", "clothing": "blue hat",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("noun", "message"),
    [
        ('how = "dearest"\nphrase = "guest"', 'how of .* is "nearest", "seen" or "all"'),
        ('how = "seen"\nphrase = "guest from {place}"', "takes the slots clothing, color"),
        ('how = "seen"\nphrase = "guest ["', "'\\['"),
    ],
)
def test_a_wrong_noun_is_told(noun: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(f'[[noun]]\ntype = "person"\n{noun}\n')
    with pytest.raises(MissionError, match=message):
        parse_tree("wave", keywords=[str(path)])


def test_nouns_in_spanish() -> None:
    mission = parse_tree("mira a la persona con hat azul. Acércate a la cup roja", world=WORLD, language="es")
    chosen = [dict(node.ports) for node in mission.tree.walk() if node.id == "Choose"]
    assert [ports["color"] for ports in chosen] == ["blue", "red"]
    assert parse_tree(str(mission.to("english")), world=WORLD, language="es").tree.root == mission.tree.root

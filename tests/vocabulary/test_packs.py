"""Packs: further keyword files add words, and can change what a connective means."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import SUCCESS
from btlang.run.events import Printed
from btlang.tree.dump import plain
from btlang.vocabulary.listing import listing
from btlang.vocabulary.load import load_vocabulary


def test_a_pack_adds_a_phrase_and_a_type(tmp_path: Path) -> None:
    pack = tmp_path / "band.toml"
    pack.write_text(
        """
        [[type]]
        name = "song"
        values = ["la paloma", { name = "hymn", words = ["hymn", "the national anthem"] }]
        [[action]]
        phrase = "play/sing {song} [for {person}]"
        id = "Play"
        resources = ["voice"]
        """
    )
    tree = parse_tree("sing the national anthem for Alice then play La Paloma", keywords=[str(pack)]).tree
    assert plain(tree) == 'Sequence\n  Play person=Alice song=hymn\n  Play song="la paloma"'
    with pytest.raises(MissionError, match=r"There's no song called 'yesterday'"):
        parse_tree("sing yesterday", keywords=[str(pack)])


def test_a_pack_sets_what_a_connective_means(tmp_path: Path) -> None:
    pack = tmp_path / "referee.toml"
    pack.write_text('[roles]\nand = ["and also"]\nthen = ["then", "and", "and then"]\n')
    assert plain(parse_tree("wave and nod", keywords=[str(pack)]).tree) == "Sequence\n  Wave\n  Nod"
    assert plain(parse_tree("wave and also nod", keywords=[str(pack)]).tree) == "Parallel\n  Wave\n  Nod"


def test_an_invented_language_is_one_file(tmp_path: Path) -> None:
    pack = tmp_path / "ka.toml"
    roles = """
        [roles]
        then = ["ka"]
        and = ["mi"]
        if = ["su {}"]
        repeat = ["ro"]
        otherwise = ["nu"]
        define = ["wa"]
        """.replace(" {}", "")
    pack.write_text("articles = []\n" + roles + '[counts]\n"ni" = 2\n')
    tree = parse_tree("fest wa wave mi nod\nsu bumped wave nu fest ka ro fest ni", keywords=[str(pack)]).tree
    expected = ["IfThenElse", "  Bumped", "  Wave", "  Sequence", "    SubTree ID=fest", "    Repeat num_cycles=2"]
    assert plain(tree).splitlines()[:6] == expected


def test_shipped_words_have_what_the_list_shows() -> None:
    vocabulary = load_vocabulary(names={"place": ["lab"], "person": ["Alice"], "object": ["cup"]})
    for entries in vocabulary.entries.values():
        for entry in entries:
            assert entry.topic, entry.id
            assert entry.help, entry.id
            assert entry.example, entry.id
            assert callable_exists(str(entry.call or entries[0].call)), entry.id  # further phrases have none
    text = "\n".join(listing(vocabulary, "dock"))
    assert "undock" in text
    assert "wave" not in text
    assert listing(vocabulary, "xyzzy") == ["No phrase has the words: xyzzy"]


def callable_exists(call: str) -> bool:
    from importlib import import_module

    module, name = call.split(":")
    return callable(getattr(import_module(module), name))


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
def test_every_example_of_a_phrase_compiles_to_its_node(parser: str) -> None:
    vocabulary = load_vocabulary()
    for entries in vocabulary.entries.values():
        for entry in entries:
            text = entry.example if entry.sort == "action" else f"check {entry.example}"
            ids = [node.id for node in parse_tree(text, parser=parser).tree.walk()]
            assert ids[0] == entry.id or (not entry.phrases and entry.id in ids), entry.example


def test_a_module_beside_its_keyword_file_is_found(tmp_path: Path) -> None:
    (tmp_path / "band_moves.py").write_text("def bow(robot):\n    robot.print('bows')\n")
    pack = tmp_path / "band.toml"
    pack.write_text('[[action]]\nphrase = "bow deeply"\nid = "BowDeeply"\ncall = "band_moves:bow"\n')
    before = list(sys.path)
    assert parse_tree("bow deeply", keywords=[str(pack)]).run(speed="max").status == SUCCESS
    assert sys.path == before


def test_packs_may_have_modules_of_the_same_name(tmp_path: Path) -> None:
    for name in "ab":
        folder = tmp_path / name
        (folder / "moves").mkdir(parents=True)
        (folder / "moves" / "__init__.py").write_text("from .where import PLACE\n")
        (folder / "moves" / "where.py").write_text(f"PLACE = {name!r}\n")
        (folder / "hops.py").write_text(
            "from .moves import PLACE\n\ndef hop(robot):\n    robot.print('hop from ' + PLACE)\n"
        )
        text = f'[[action]]\nphrase = "hop {name}"\nid = "Hop{name}"\ncall = "hops:hop"\n'
        (folder / "hops.toml").write_text(text)
    said: list[str] = []
    packs = [str(tmp_path / name / "hops.toml") for name in "ab"]
    tree = parse_tree("hop a then hop b", keywords=packs)
    tree.run(speed="max", sinks=[lambda e: said.append(e.text) if isinstance(e, Printed) else None])
    assert said == ["hop from a", "hop from b"]


def test_a_module_in_a_plain_folder_beside_its_keyword_file(tmp_path: Path) -> None:
    (tmp_path / "steps").mkdir()
    (tmp_path / "steps" / "big.py").write_text("def stride():\n    return True\n")
    (tmp_path / "steps.toml").write_text('[[action]]\nphrase = "stride"\nid = "Stride"\ncall = "steps.big:stride"\n')
    assert parse_tree("stride", keywords=[str(tmp_path / "steps.toml")]).run(speed="max").status == SUCCESS


def test_a_module_that_imports_another_one_beside_it(tmp_path: Path) -> None:
    (tmp_path / "steps.py").write_text("")
    (tmp_path / "walk.py").write_text("import steps\n")
    (tmp_path / "walk.toml").write_text('[[action]]\nphrase = "strut"\nid = "Strut"\ncall = "walk:strut"\n')
    with pytest.raises(MissionError, match=r"write 'from \. import steps'"):
        parse_tree("strut", keywords=[str(tmp_path / "walk.toml")]).run(speed="max")


def test_an_installed_pack_is_named_by_its_entry_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "gym_words").mkdir()
    (tmp_path / "gym_words" / "__init__.py").write_text("")
    (tmp_path / "gym_words" / "gym.toml").write_text('[[action]]\nphrase = "do press-ups"\nid = "PressUp"\n')
    information = tmp_path / "gym_words-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: gym-words\nVersion: 1.0\n")
    (information / "entry_points.txt").write_text("[btlang.keywords]\ngym = gym_words\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert plain(parse_tree("do press-ups twice", keywords=["gym"]).tree) == "Repeat num_cycles=2\n  PressUp"
    with pytest.raises(MissionError, match=r"its keyword entry in .* has no call"):
        parse_tree("do press-ups", keywords=["gym"]).run()


def test_a_unit_with_a_mark_is_said_with_and_without_a_blank(tmp_path: Path) -> None:
    pack = tmp_path / "weather.toml"
    pack.write_text(
        '[[type]]\nname = "temperature"\nunits = [{ words = ["°C", "degrees celsius"], factor = "1" }]\n\n'
        '[[quantity]]\nphrase = "the room temperature"\ntype = "temperature"\nid = "RoomTemperature"\n'
        'call = "btlang.actions.sensing:distance_ahead"\nhelp = "."\nexample = "the room temperature is above 30 °C"\n',
        encoding="utf-8",
    )
    said = ["30 °C", "30°C", "30 degrees Celsius"]
    trees = [parse_tree(f"if the room temperature is above {value}, wave", keywords=[str(pack)]) for value in said]
    assert {str(tree.to("english")) for tree in trees} == {"if the room temperature is above 30°C, wave\n"}
    turned = parse_tree("turn left 40°", keywords=[str(pack)])
    assert dict(turned.tree.root.ports) == {"angle": "40"}


def test_words_of_a_pack_win_over_further_shipped_ones(tmp_path: Path) -> None:
    pack = tmp_path / "own.toml"
    pack.write_text(
        '[[action]]\nphrase = "shout {text}"\nid = "Shout"\nslots = { text = "text" }\n'
        '[[action]]\nphrase = "count to {number}"\nid = "CountMine"\nslots = { number = "number" }\n'
    )
    assert plain(parse_tree("shout hi").tree) == "Say text=hi"
    own = plain(parse_tree("shout hi then count to 3", keywords=[str(pack)]).tree).splitlines()
    assert own == ["Sequence", "  Shout text=hi", "  CountMine number=3"]

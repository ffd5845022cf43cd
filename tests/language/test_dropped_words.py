"""What is left out of a sentence where the world tells nothing of it, with a note, and other words for its names."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from tests.language.test_meaning import PARSERS, in_one_line


@pytest.mark.parametrize("parser", PARSERS)
@pytest.mark.parametrize(
    ("sentence", "tree", "codes"),
    [
        ("bring Bob a cup of tea", "Bring object=cup person=Bob", ["BT158"]),
        ("take the bottle of cold water to the lab", "Take object=bottle place=lab", ["BT158"]),
        ("ask Bob if he wants a cup of tea", 'Ask person=Bob question="Do you want a cup of tea?"', ["BT149"]),
        ("go to the hallway", "GoTo place=hall", []),
        ("go to the lounge", 'GoTo place="living room"', []),
        ("go to the charging station", "GoTo place=dock", []),
    ],
)
def test_left_out_and_other_names(sentence: str, tree: str, codes: list[str], parser: str) -> None:
    mission = btlang.parse_tree(sentence, parser=parser)
    assert in_one_line(mission) == tree
    assert [warning.code for warning in mission.warnings] == codes


def test_a_name_of_the_world_is_itself(tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    places = '[{ name = "hall", x = 1, y = 1 }, { name = "corridor", x = 2, y = 1 }]'
    world.write_text(f"start = {{ x = 0, y = 0 }}\nplaces = {places}\n", encoding="utf-8")
    assert in_one_line(btlang.parse_tree("go to the corridor", world=world)) == "GoTo place=corridor"
    with pytest.raises(btlang.MissionError, match="hallway"):  # the hall, or the corridor
        btlang.parse_tree("go to the hallway", world=world)


@pytest.mark.parametrize("parser", PARSERS)
@pytest.mark.parametrize("sentence", ["go to the green square", "go to the green rectangular room", "go to the green"])
def test_shapes_of_places_with_a_color(sentence: str, parser: str, tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    places = '[{ name = "green room", x = 1, y = 1 }, { name = "blue room", x = 2, y = 1 }]'
    world.write_text(f"start = {{ x = 0, y = 0 }}\nplaces = {places}\n", encoding="utf-8")
    assert in_one_line(btlang.parse_tree(sentence, world=world, parser=parser)) == 'GoTo place="green room"'

"""What words need of a robot: `needs`, and `resources` as version 0.1 had them."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.vocabulary.capabilities import part_of, resources_of

FILE = """
[[action]]
phrase = "measure"
id = "Measure"
{keys}

[[action]]
phrase = "polish"
id = "Polish"
{keys}
"""


def together(folder: Path, keys: str) -> btlang.Mission:
    """Two words of the same keys at the same time."""
    path = folder / "words.toml"
    path.write_text(FILE.format(keys=keys))
    return btlang.parse_tree("measure and polish at the same time", keywords=[str(path)])


@pytest.mark.parametrize(
    "keys",
    [
        'needs = ["navigation"]',
        'needs = ["lift"]',
        'needs = ["hand", "posture wave"]',
        'resources = ["network"]',
        'resources = ["network"]\nneeds = ["scanner"]',
    ],
)
def test_one_at_a_time(tmp_path: Path, keys: str) -> None:
    with pytest.raises(btlang.MissionError, match="BT041"):
        together(tmp_path, keys)


@pytest.mark.parametrize("keys", ["", 'needs = ["scanner", "battery", "pose"]', 'needs = ["posture wave", "joints"]'])
def test_any_number_at_a_time(tmp_path: Path, keys: str) -> None:
    assert together(tmp_path, keys).warnings == ()


def test_needs_is_a_list_of_names(tmp_path: Path) -> None:
    with pytest.raises(btlang.MissionError) as caught:
        together(tmp_path, "needs = 3")
    first, second = (diagnostic.span for diagnostic in caught.value.diagnostics)
    assert "needs of 'measure' must be a list of names" in str(caught.value)
    assert first.start < second.start


def test_conditions_take_nothing_for_themselves(tmp_path: Path) -> None:
    path = tmp_path / "words.toml"
    path.write_text('[[condition]]\nphrase = "level"\nid = "Level"\nneeds = ["base"]\n')
    [entry] = btlang.parse_tree("check level", keywords=[str(path)]).vocabulary.entries["Level"]
    assert (entry.needs, entry.resources) == (("base",), ())


def test_a_message_points_at_its_own_entry(tmp_path: Path) -> None:
    path = tmp_path / "words.toml"
    path.write_text('[[action]]\nphrase = "bow"\nid = "Bow"\n\n[[action]]\nphrase = "bow"\nid = "If"\nlegs = 2\n')
    with pytest.raises(btlang.MissionError, match=r"words.toml:6:11: error BT060.* 'legs' is not a key"):
        btlang.parse_tree("bow", keywords=[str(path)])


def test_resources_of_needs() -> None:
    assert resources_of(["navigation", "right hand", "holding", "right arm"]) == ("base", "right arm")
    assert (part_of("holding"), part_of("lift"), part_of("posture nod")) == ("hand", "lift", 'posture "nod"')

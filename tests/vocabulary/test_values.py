"""Values in slots: what people write and the port text that it becomes."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import btlang
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary.value_type import format_number

VOCABULARY = world_vocabulary()


@pytest.mark.parametrize(
    ("kind", "written", "expected"),
    [
        ("length", "2 m", "2"),
        ("length", "2m", "2"),
        ("length", "two meters", "2"),
        ("length", "half a meter", "0.5"),
        ("length", "a quarter of a meter", "0.25"),
        ("length", "one and a half metres", "1.5"),
        ("length", "57 cm", "0.57"),
        ("length", "a meter", "1"),
        ("length", "3 km", "3000"),
        ("angle", "90 degrees", "90"),
        ("angle", "90°", "90"),
        ("angle", "half a turn", None),
        ("angle", "a full turn", "360"),
        ("duration", "1.5 s", "1.5"),
        ("duration", "two and a half minutes", "150"),
        ("duration", "a minute and a half", "90"),
        ("length", "2 m and a half", "2.5"),
        ("length", "1 m and half a meter", None),
        ("duration", "twenty-five seconds", "25"),
        ("duration", "an hour", "3600"),
        ("duration", "200 ms", "0.2"),
        ("duration", "-1 s", None),
        ("percent", "20%", "20"),
        ("percent", "twenty percent", "20"),
        ("number", "-2.5", "-2.5"),
        ("number", "three hundred", "300"),
        ("number", "3 m", None),
        ("count", "3", "3"),
        ("count", "0", None),
        ("count", "2.5", None),
        ("length", "2 s", None),
        ("length", "2", None),
        ("length", "1e999 m", None),
        ("length", "two " + "thousand " * 110 + "m", None),
        ("length", "nine thousand thousand thousand thousand thousand m", None),
        ("text", "hello", "hello"),
        ("text", "Hello", "Hello"),
        ("text", '"Hello, World"', "Hello, World"),
        ("text", '""', ""),
        ("text", "a", "a"),
        ("place", "the LAB", "lab"),
        ("place", '"living room"', "living room"),
        ("place", "living room", "living room"),
        ("place", "living", None),
        ("place", "'the lab'", "lab"),
        ("person", "alice", "Alice"),
    ],
)
def test_value(kind: str, written: str, expected: str | None) -> None:
    assert VOCABULARY.value(kind, written) == expected


@given(st.floats(-1e9, 1e9))
def test_numbers_read_back(number: float) -> None:
    assert float(format_number(number)) == number


def test_names_may_have_figures_before_letters(tmp_path: Path) -> None:
    world = tmp_path / "school.toml"
    world.write_text(
        'start = { x = 1, y = 1 }\nplaces = [{ name = "class 3b", x = 1, y = 1 }, { name = "bay 2", x = 2, y = 1 }]',
        encoding="utf-8",
    )
    for parser in ("shunting-yard", "lark"):
        mission = btlang.parse_tree("go to class 3b, then to bay 2", world=str(world), parser=parser)
        assert [dict(node.ports)["place"] for node in mission.tree.root.children] == ["class 3b", "bay 2"]
        assert "class 3b" in str(mission.to("english"))

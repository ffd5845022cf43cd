"""Ranges of names with numbers: `tables 1 to 3`."""

from __future__ import annotations

import pytest

import btlang
from btlang.text.source import Source

WORLD = Source(
    "start = { x = 0, y = 0 }\nplaces = ["
    + ", ".join(f'{{ name = "table {number}", x = {number}, y = 1, kind = "table" }}' for number in range(1, 5))
    + "]\n",
    "world.toml",
)


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("go to tables 1 to 3", "123"),
        ("go to table 2 to table 4", "234"),
        ("take a picture of table 2 to table 3", "23"),
        ("go from table 1 to table 4", "14"),  # a journey
        ('go from table 1 to table 3, and at each table say "Hi"', "123"),
    ],
)
def test_each_number_is_a_name(text: str, numbers: str, parser: str) -> None:
    tree = btlang.parse_tree(text, world=WORLD, parser=parser).tree
    ports = (pair for node in tree.walk() for pair in node.ports)
    named = [value for port, value in ports if port == "place" and value[0] != "{"]
    assert named == [f"table {number}" for number in numbers]

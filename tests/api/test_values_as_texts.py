"""A number where a text is wanted is said as people read it."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.run.events import Said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('set counter to 3; say "{counter}"', "3"),
        ("set gap to half a meter; say {gap}", "0.5"),
        ('remember the battery as level; say "{level}"', "100"),
        ('tell {number} is say "{number}"; set counter to 3; increase counter; tell counter', "4"),
        ('set code to "1.50"; say {code}', "1.50"),
    ],
)
def test_a_text_that_is_one_number(text: str, said: str) -> None:
    heard: list[object] = []
    parse_tree(text).run(speed="max", sinks=[heard.append])
    assert [event.text for event in heard if isinstance(event, Said)] == [said]

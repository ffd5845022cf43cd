"""Warnings that are told beside an error, of the sentences before it."""

from __future__ import annotations

import pytest

import btlang


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ('ask Alice "Tea?". If so, tell Bob about her cup', ["BT149", "BT159"]),
        ("When someone is near, wave. Blork.", ["BT068", "BT010"]),
        ("Blork. When someone is near, wave.", ["BT010"]),  # it may depend on what isn't understood
        ('When someone is near, say "Hi. Who is there?". Blork.', ["BT068", "BT010"]),
        ("When someone is near, blork.", ["BT010"]),
    ],
)
def test_what_stands_before_an_error_is_warned_of(text: str, codes: list[str]) -> None:
    with pytest.raises(btlang.MissionError) as refused:
        btlang.parse_tree(text)
    assert [each.code for each in refused.value.diagnostics] == codes
    assert all(each.span.source.text == text for each in refused.value.diagnostics)

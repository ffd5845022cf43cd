"""What the warnings about conditions that come too late advise: it is read without an error, and asks in time."""

from __future__ import annotations

import pytest

import btlang

PARSERS = ("shunting-yard", "lark")


@pytest.mark.parametrize("parser", PARSERS)
@pytest.mark.parametrize(
    ("text", "advised"),
    [
        (
            'go to the kitchen. If the kitchen door is closed, say "Please open" and wait a minute',
            'If the kitchen door is closed, say "Please open" and wait a minute. Then go to the kitchen',
        ),
        (
            "Take the cup to Alice in the kitchen. If the kitchen door is closed, wave",
            "If the kitchen door is closed, wave. Then take the cup to Alice in the kitchen",
        ),
        (
            "go to the kitchen, and if the kitchen door isn't open, go to the dock",
            "If the kitchen door isn't open, go to the dock, otherwise go to the kitchen",
        ),
        (
            "go to the lab and ask Alice what she wants. Then go to Bob. If Alice isn't in the lab, come back",
            "if Alice isn't in the lab, come back, otherwise ask Alice what she wants",
        ),
        ("bring the cup to the kitchen. If the kitchen door is closed, bring it back", ""),
        (
            "go to the lab and bring Alice the cup. Take the book and bring it to Bob. If Alice isn't in the lab, nod",
            "if Alice isn't in the lab, nod, otherwise bring Alice the cup",
        ),
    ],
)
def test_what_is_advised(text: str, advised: str, parser: str) -> None:
    (warning,) = (each for each in btlang.parse_tree(text, parser=parser).warnings if each.code == "BT068")
    _, _, said = warning.hint.partition("write: ")
    assert said == advised
    codes = [each.code for each in btlang.parse_tree(said or "wave", parser=parser).warnings]
    assert "BT068" not in codes

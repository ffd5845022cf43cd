"""A line that begins with `otherwise` goes on with the statement above it, whatever ended that."""

from __future__ import annotations

import pytest

import btlang
from btlang.diagnostics.diagnostic import MissionError
from btlang.tree.dump import plain

PARSERS = ("shunting-yard", "lark")


def tree_of(text: str) -> str:
    trees = {plain(btlang.parse_tree(text, parser=parser).tree) for parser in PARSERS}
    assert len(trees) == 1
    return trees.pop()


@pytest.mark.parametrize("stop", [".", ";", "!", "..", " ."])
def test_after_a_stop(stop: str) -> None:
    assert tree_of(f"wave{stop}\notherwise nod{stop}") == tree_of("wave\notherwise nod")
    assert tree_of(f"if the battery is low, wave{stop}\notherwise nod{stop}") == tree_of(
        "if the battery is low, wave otherwise nod"
    )


def test_behind_a_rule_it_is_about_what_the_rule_does() -> None:
    one_line = tree_of("whenever the battery is low, dock otherwise nod\ngo to the lobby")
    assert one_line.startswith("Whenever\n  BatteryLow\n  Fallback\n    Dock\n    Nod\n  GoTo")
    for otherwise in ("otherwise nod", "otherwise:\n    nod"):
        assert tree_of(f"whenever the battery is low:\n    dock\n{otherwise}\ngo to the lobby") == one_line


def test_behind_a_definition_it_is_about_its_command() -> None:
    assert tree_of("patrol is:\n    wave.\notherwise nod.\npatrol") == tree_of("patrol is wave otherwise nod\npatrol")


@pytest.mark.parametrize("parser", PARSERS)
@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("frobnicate wave at {speaker} then nod", ["BT010 frobnicate", "BT043 {speaker}"]),
        ("go to Alice then frobnicate wave at her", ["BT010 frobnicate"]),
        ("set x to 3\nfrobnicate at the lab {x} times then nod", ["BT010 frobnicate"]),
    ],
)
def test_an_unknown_word_swallows_no_phrase(text: str, codes: list[str], parser: str) -> None:
    with pytest.raises(MissionError) as error:
        btlang.parse_tree(text, parser=parser)
    assert [f"{problem.code} {problem.span.text}" for problem in error.value.diagnostics] == codes

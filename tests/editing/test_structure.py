"""Lines that fold, brackets that show a reading, trees of statements, and where names lead."""

from __future__ import annotations

import pytest

from btlang.editing.reading import TextReading
from btlang.editing.references import references
from btlang.editing.structure import folds, reading_brackets, statement_tree
from btlang.editing.words import RobotWords
from btlang.text.source import Source


def read(text: str) -> TextReading:
    return TextReading(Source(text), RobotWords())


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("", []), ("wave\nnod\n", []), ("repeat twice:\n  wave\n\nnod\n", [(0, 1)]),
        ("a:\n  b:\n    c\n  d\ne\n", [(0, 3), (1, 2)]), ("# one\n# two\nwave\n# three\n", [(0, 1)]),
        ("a:\n  b\n# c\n\n  d", [(0, 4)]),
    ],
)  # fmt: skip
def test_folds(text: str, lines: list[tuple[int, int]]) -> None:
    assert folds(text) == lines


@pytest.mark.parametrize(
    "shown",
    [
        "wave", "wave then nod", "go to the lab and (wave twice)", "go to the lab, then (nod or wave)",
        "if the ((path is clear and the battery is full) or bumped), (wave, then nod)",
        "(go to the lab, the kitchen and the lobby), then nod",
        "patrol is go to the lab and then (wave and nod)\npatrol",
        "repeat 3 times:\n  wave\n  if bumped:\n    nod", "go to the lab, wave, nod and (dock within 20 s)",
    ],
)  # fmt: skip
def test_brackets_show_how_words_are_joined(shown: str) -> None:
    text = shown.replace("(", "").replace(")", "")
    made = text
    for bracket in reversed(reading_brackets(read(text))):
        made = made[: bracket.at] + bracket.text + made[bracket.at :]
    assert made.replace("((the path", "the ((path") == shown


def test_no_brackets_where_there_are_some() -> None:
    assert reading_brackets(read("undock or (nod and wave)\n")) == []


def test_trees_of_statements() -> None:
    text = "wave\nrepeat 2 times:\n  nod\n  if bumped, wave\n"
    assert statement_tree(read(text), 1) == "Wave: wave"
    assert statement_tree(read(text), text.index("bumped")).startswith("IfThenElse\n├── Bumped: bumped\n")
    assert statement_tree(read("frobnicate"), 1) == ""


def test_names_of_a_mission_lead_to_their_places() -> None:
    text = "the depot is at (3, 4)\npatrol is go to the  living   room\npatrol twice\ngo to the depot and the lobby\n"
    found = {text[each.start : each.end]: each.target for each in references(read(text))}
    assert (found["patrol"].start, found["depot"].text) == (text.index("patrol"), "depot is at (3, 4)")
    assert found["living   room"].text == "living room"
    assert found["lobby"].source.name.endswith("default.toml")
    assert found["go to the depot and the lobby"].source.name == "keywords/en/navigation.toml"

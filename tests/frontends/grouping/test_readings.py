"""Warnings of sentences that are about more or less than people mean: both readings can be pasted."""

from __future__ import annotations

import pytest

from btlang.api import Mission, parse_tree
from btlang.diagnostics.diagnostic import Diagnostic, MissionError

ASKED = [
    ("as soon as someone is near, wave\ngo to the lab", "BT171"),
    ("once someone is near, then wave. Go to the lab. Nod.", "BT171"),
    ("whenever bumped, nod\nthe moment someone is near, wave\ngo to the lab", "BT171"),
    ("repeat 2 times:\n  as soon as someone is near, wave then nod\n  go to the lab", "BT171"),
    ("go to the lab then wave. Do that 3 times", "BT172"),
    ("if someone is near, wave then nod. Do it again", "BT172"),
    ("go to the lab\nwave\ndo this twice", "BT172"),
    ("go to the lab. Nod twice. Again.", "BT172"),
    ("wave. Nod then wave, then nod. Do that until bumped.", "BT172"),
    ("nod. Repeat that twice.", "BT172"),
    ("wave\nnod then wave\nstart over", "BT172"),
]
PLAIN = [
    "as soon as someone is near, wave",
    "as soon as someone is near, wave then go to the lab",
    "as soon as someone is near, wave. Then go to the lab.",
    "go to the lab\nas soon as someone is near, wave\nnod",
    "wait until someone is near then wave\ngo to the lab",
    "nod. Do that 3 times.",
    "go to the lobby, the lab and the dock. Again.",
    "nod. Repeat that.",
    "nod. Repeat that once.",
    "nod. Start over.",
    "wave\nnod\nrepeat everything 3 times",
    "repeat 3 times:\n  wave\n  nod\nDo that again",
]


@pytest.mark.parametrize("text", ["moment\nsomeone\nit", "once someone is near\nwave", "start over\nwave\nagain"])
def test_broken_statements_have_no_reading(text: str) -> None:
    with pytest.raises(MissionError):
        parse_tree(text)


def told(mission: Mission) -> list[Diagnostic]:
    return [warning for warning in mission.warnings if warning.code in ("BT171", "BT172")]


@pytest.mark.parametrize("text", PLAIN)
def test_what_has_one_reading_is_not_asked_about(text: str) -> None:
    assert told(parse_tree(text)) == []


@pytest.mark.parametrize(("text", "code"), ASKED)
def test_the_first_reading_is_the_one_that_was_taken_and_the_second_is_another(text: str, code: str) -> None:
    mission = parse_tree(text)
    warning = told(mission)[0]
    assert warning.code == code
    trees = []
    for span, words in warning.readings:
        other = parse_tree(text[: span.start] + words + text[span.end :])
        assert warning.message not in [each.message for each in told(other)]
        trees.append(other.tree)
    assert mission.tree in trees
    assert len(trees) == 2
    assert trees[0] != trees[1]

"""What the note about questions without an answer advises: it is read without an error, and then nothing is noted."""

from __future__ import annotations

import re

import pytest

import btlang
from btlang.diagnostics.diagnostic import Diagnostic

PARSERS = ("shunting-yard", "lark")
_SAID = re.compile(r"To say what is done then, (?:add behind the answers|write): (.*), \.\.\.")


def notes(text: str, parser: str = "shunting-yard") -> list[Diagnostic]:
    """The notes about silence of a mission."""
    mission = btlang.parse_tree(text, parser=parser)
    return [warning for warning in mission.warnings if warning.code == "BT253"]


@pytest.mark.parametrize("parser", PARSERS)
@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('ask Bob "Tea?". If he says yes, wave. If he says no, nod. ', ""),
        ('ask Alice "Tea?". If she says yes, wave. If she says no, nod. ', "Dock"),
        ('go to Bob. Ask him "Tea?", and if he says yes, wave, and if he says no, nod. ', ""),
        ('ask somebody "Tea?". If they say yes, wave. ', "Dock"),
        ("ask Bob if he wants tea. If he does, wave. ", "Dock"),
        ('ask Bob "Tea?". If the answer is yes, wave. ', "Dock"),
        ('ask Bob "Tea?" within 10 s. If Bob says yes, wave. ', "Dock"),
        ('ask me "Tea?". If I say yes, wave. If I say no, nod. ', ""),
        ('ask Bob "Tea?". If he doesn\'t say yes, wave. ', "Dock"),
        ('if bumped:\n  ask Bob "Tea?"\n  if he says yes, wave\n  if he says no, nod\n  ', ""),
        ('offer is:\n  ask Bob "Tea?"\n  if he says yes, wave\n  ', "offer\ndock"),
        ('whenever somebody is near, ask them "Tea?". If they say yes, wave. ', ""),
        ('whenever somebody is near, ask them "Tea?", and if they say yes, wave. ', ""),
        ('whenever bumped:\n  ask Bob "Tea?"\n  if he says yes, wave\n  ', ""),
    ],
)
def test_what_is_said_behind_the_answers(before: str, after: str, parser: str) -> None:
    (note,) = notes(f"{before}\n{after}", parser)
    said = _SAID.search(note.hint)
    assert said is not None
    assert notes(f'{before}{said[1]}, say "Hello?"\n{after}', parser) == []


@pytest.mark.parametrize("parser", PARSERS)
@pytest.mark.parametrize(
    "text",
    [
        'if bumped, ask Bob "Tea?". If he says yes, wave. If he says no, nod',
        'ask Bob "Tea?", and wave if he says yes. Dock',
        'ask Bob "Tea?". Then wave. If he says no, nod',
        "ask Bob if he wants tea. If he says yes, wave, and if he says no, ask Alice",
        'whenever somebody is near, ask them "Tea?"',
        'whenever somebody is near, ask them "Tea?". If they say yes, wave',
        "whenever bumped, listen for hello",
    ],
)
def test_a_try_before_the_question(text: str, parser: str) -> None:
    (note,) = notes(text, parser)
    ((span, tried),) = note.readings
    assert tried in note.hint
    assert notes(f"{text[: span.start]}{tried}{text[span.end :]}", parser) == []


@pytest.mark.parametrize("parser", PARSERS)
def test_a_question_that_is_asked_several_times(parser: str) -> None:
    asked, replies = 'ask Bob "Tea?" up to 3 times', ". If he says yes, wave. Dock"
    (note,) = notes(asked + replies, parser)
    said = _SAID.search(note.hint)
    assert said is not None
    assert said[1].startswith(asked)
    assert notes(f"{said[1]}, nod{replies}", parser) == []

"""Ids of nodes that nothing has: a change is offered where only one node or subtree can have been meant."""

from __future__ import annotations

import pytest

import btlang
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.text.source import Source


def problem_of(text: str) -> Diagnostic:
    with pytest.raises(MissionError) as caught:
        btlang.parse_tree(Source(text, "m.txt")).check()
    [problem] = [problem for problem in caught.value.diagnostics if problem.is_error]
    return problem


@pytest.mark.parametrize(
    ("broken", "sound"),
    [
        ('"Tour" is: wave\ndo "Tuor"', '"Tour" is: wave\ndo "Tour"'),
        ('"Tour" is: wave\ndo tuor then nod', '"Tour" is: wave\ndo tour then nod'),
        ('"Tour Guide" is: wave\ndo the tuor giude', '"Tour Guide" is: wave\ndo the tour guide'),
        ('"Tour, long" is: wave\ndo tuor long', '"Tour, long" is: wave\ndo "Tour, long"'),
        ('"Tour" is: wave\ndo subtree "Tuor"', '"Tour" is: wave\ndo subtree "Tour"'),
        ('tour is wave\ndo "Tuor"', "tour is wave\ndo tour"),
        ('wave then do "PointtAtPlace" with place "lab"', 'wave then do "PointAtPlace" with place "lab"'),
        ('do pointt at place with place "lab"', 'do point at place with place "lab"'),
        ('if test "BateryLow", wave', 'if test "BatteryLow", wave'),
    ],
)
def test_fix(broken: str, sound: str) -> None:
    problem = problem_of(broken)
    assert problem.fix is not None
    span, words = problem.fix
    assert broken[: span.start] + words + broken[span.end :] == sound
    assert "Similar: " in problem.hint
    assert "[[action]]" not in problem.hint
    btlang.parse_tree(sound).check()


@pytest.mark.parametrize(
    "text",
    [
        'do "PourCup"',  # not near
        'do "Cook"',  # correct English, though `Look` is near
        'do "OpnDoor" with dor "lab door"',  # OpenDoor has no such port
        '"Tour" is: wave\n"Tuur" is: nod\ndo "Tuor"',  # two are near
        '"Tour" is: wave\ndo node "Tuor"',  # no subtree
        'tour is wave\ndo "Tuor" called "first"',  # said by a phrase, which takes no name
        '"Tour" is: wave\nif test "Tuor", nod',
        '<root BTCPP_format="4"><BehaviorTree ID="M"><Waev name="Waev"/></BehaviorTree></root>',
    ],
)
def test_no_fix(text: str) -> None:
    problem = problem_of(text)
    assert (problem.code, problem.fix) == ("BT130", None)
    assert "This entry of a keyword file would define it" in problem.hint


def test_names_that_are_said_otherwise_are_known() -> None:
    """The language `eo` is said as Esperanto."""
    btlang.parse_tree('talk in Esperanto; do "SpeakLanguage" with language "eo"').check()

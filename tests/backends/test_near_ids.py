"""Ids of nodes that nothing has: a change is offered where only one node or subtree can have been meant."""

from __future__ import annotations

from pathlib import Path

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


def test_the_keyword_file_beside_a_tree_that_has_an_id_is_named(tmp_path: Path) -> None:
    (tmp_path / "broken.toml").write_bytes(b"\xff")
    (tmp_path / "world.toml").write_text('id = "PourCup"\n', encoding="utf-8")
    words = tmp_path / "words.toml"
    words.write_text('[[action]]\nphrase = "pour a cup"\nid = "PourCup"\ncall = "x:y"\n', encoding="utf-8")
    text = '<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence><PourCup/><PourCap/></Sequence></BehaviorTree></root>'
    (tmp_path / "tree.xml").write_text(text, encoding="utf-8")
    with pytest.raises(MissionError) as caught:
        btlang.parse_file(tmp_path / "tree.xml").check()
    known, unknown = caught.value.diagnostics
    assert known.hint == f"The keyword file {words} has it. Add: --keywords {words}"
    assert "If a keyword file of yours has it, add: --keywords FILE" in unknown.hint
    hidden = problem_of(text.replace("<PourCap/>", ""))  # of a text from outside the folder isn't read
    assert str(words) not in hidden.hint
    btlang.parse_tree(Source(text.replace("<PourCap/>", "")), keywords=[words])

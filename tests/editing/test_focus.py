"""A part of a text that is read alone: what it says of its statements, and that all of it stays in its place."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.editing.focus import decisive_places, focus_on, provisional_problems, without_statements
from btlang.editing.reading import TextReading
from btlang.editing.words import RobotWords
from btlang.frontends.mission.completion import completer
from btlang.text.source import Source
from tests.benchmarks.missions import mission
from tests.profiles import amount, searches

WORDS = RobotWords()
TYPED = (
    "wave", "go to the labb", "nod twice", "if bumped, wave and nod", "then wave", 'say "hi', "look around and",
    "(wave", "patrol then go to the depot", "xyzzy is nod", "otherwise nod",
)  # fmt: skip


@searches(40, 2_000)
@given(st.text(st.sampled_from("ab \n#\t:é"), max_size=60), st.data())
def test_what_is_left_stays_in_its_place(text: str, data: st.DataObject) -> None:
    places = st.integers(0, len(text))
    start, end = sorted((data.draw(places), data.draw(places)))
    focus = focus_on(text, start, end, data.draw(st.lists(places, max_size=3)))
    assert len(focus.text) == len(text)
    assert all(one in (other, " ") for one, other in zip(focus.text, text, strict=True))
    assert focus.text.count("\n") == text.count("\n")
    assert focus.start <= end
    assert focus.text[focus.start : focus.end] == text[focus.start : focus.end]
    assert len(without_statements(text, [start])) == len(text)


@pytest.mark.long
def test_a_part_has_the_problems_that_it_has_in_the_whole() -> None:
    random, text = Random(5), "patrol is wave then nod\nthe depot is at (3, 4)\n" + mission(120)
    lines = text.split("\n")
    decisive = decisive_places(TextReading(Source(text), WORDS).lexer)
    assert decisive
    for _ in range(amount(15, 400)):
        at = random.randrange(5, len(lines) - 5)
        margin = lines[at][: len(lines[at]) - len(lines[at].lstrip())]
        line = f"{margin}{random.choice(TYPED)}\n"
        start = Source(text).offset(at + 1)
        changed = text[:start] + line + text[start:]
        focus = focus_on(changed, start, start + len(line) - 1, [d if d < start else d + len(line) for d in decisive])
        part = provisional_problems(Source(focus.text), WORDS)
        whole = TextReading(Source(changed), WORDS).problems
        of_part, of_whole = (
            sorted((each.code, each.span.start) for each in found if focus.start <= each.span.start < focus.end)
            for found in (part, whole)
        )
        assert of_part == of_whole


@pytest.mark.long
def test_completion_depends_on_the_last_statements_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    random, text = Random(3), mission(100)
    vocabulary = WORDS.vocabulary(Source(""))
    for _ in range(amount(10, 300)):
        before = text[: random.randrange(len(text) // 2, len(text))]
        short = completer.Completer(before, vocabulary).found()
        with monkeypatch.context() as patch:
            patch.setattr(completer, "_MOST_STATEMENTS_BACK", 10_000)
            assert completer.Completer(before, vocabulary).found() == short

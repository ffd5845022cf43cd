"""Marks in what is said."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.speech.marks import GestureMark, read_marks, sentence_start

SAMPLES = sorted((Path(__file__).parent / "samples").glob("*.txt"))


@pytest.mark.parametrize(
    ("text", "plain", "marks"),
    [
        ("hello", "hello", ()),
        ("Welcome <wave> to us", "Welcome to us", (("wave", 8),)),
        ("<point at  the\nstatue> This", "This", (("point at the statue", 0),)),
        ("Goodbye <wave>.", "Goodbye.", (("wave", 7),)),
        ("Goodbye. <wave>", "Goodbye.", (("wave", 8),)),
        ("Hi<wave>there", "Hithere", (("wave", 2),)),
        ("<bow><nod> Hi", "Hi", (("bow", 0), ("nod", 0))),
        ("<bow> <nod> Hi", "Hi", (("bow", 0), ("nod", 0))),
        (r"It costs \<nothing>", "It costs <nothing>", ()),
        ("4 < 5 and 3 > 2, <3 <", "4 < 5 and 3 > 2, <3 <", ()),
        ("a <b <wave> c", "a <b c", (("wave", 5),)),
        ("<> <\t>", "<> <\t>", ()),
        ("¡Hola <wave>! ¿Qué", "¡Hola! ¿Qué", (("wave", 5),)),
    ],
)
def test_marks_are_taken_out(text: str, plain: str, marks: tuple[tuple[str, int], ...]) -> None:
    assert read_marks(text) == (plain, tuple(GestureMark(*mark) for mark in marks))


@given(st.text(alphabet="<>\\ a.9\n"))
def test_any_text_has_marks_in_order(text: str) -> None:
    plain, marks = read_marks(text)
    assert len(plain) <= len(text)
    indices = [mark.index for mark in marks]
    assert indices == sorted(indices)
    assert not indices or indices[-1] <= len(plain)


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_commentaries_have_marks(path: Path) -> None:
    plain, marks = read_marks(path.read_text(encoding="utf-8"))
    assert len(marks) >= 2 - (path.stem == "numbers")
    assert "  " not in plain
    assert ("<" in plain) == (path.stem == "numbers")


def test_sentences_begin_behind_their_ends() -> None:
    text = 'One 1.5 m. "Two!" Three? Four'
    assert [text[sentence_start(text, at) :][:4] for at in (0, 9, 11, 16, 18, 24, 25, 99)] == [
        "One ", "One ", '"Two', '"Two', "Thre", "Thre", "Four", "Four",
    ]  # fmt: skip

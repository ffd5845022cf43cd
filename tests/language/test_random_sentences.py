"""Beginnings and ends of sentences of the golden files, put together: both parsers read the same, or say the same."""

from __future__ import annotations

from hypothesis import example, given
from hypothesis import strategies as st

import btlang
from btlang.diagnostics.diagnostic import MissionError
from btlang.tree.node import Tree
from tests.language.test_meaning import WORLD, rows
from tests.profiles import searches

_FILES = ("meaning.txt", "said.txt", "users.txt", "chosen.txt", "spoken.txt")
_SENTENCES = [sentence.split() for file in _FILES for sentence, _ in rows(file)]
_WORDS = sorted({word for sentence in _SENTENCES for word in sentence})
_some = st.sampled_from(_SENTENCES)


@st.composite
def _texts(draw: st.DrawFn) -> str:
    first, second = draw(_some), draw(_some)
    between = draw(st.lists(st.sampled_from(_WORDS), max_size=2))
    begin = draw(st.integers(1, len(first)))
    return " ".join([*first[:begin], *between, *second[draw(st.integers(0, len(second) - 1)) :]])


@searches(80, 20_000)
@given(_texts())
@example("robot, is the kitchen door open? then pick it up")
@example("if the 3 attempts, otherwise wave")
def test_both_parsers_read_what_nobody_wrote(text: str) -> None:
    assert _read(text, "shunting-yard") == _read(text, "lark")


def _read(text: str, parser: str) -> Tree | list[str]:
    try:
        return btlang.parse_tree(text, world=WORLD, parser=parser).tree
    except MissionError as error:
        return [problem.code for problem in error.diagnostics]

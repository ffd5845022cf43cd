"""The words of the language in any order: both parsers read the same, and what is no mission is refused, no more."""

from __future__ import annotations

from hypothesis import example, given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.tree.ast import Program
from tests.language.letters import read
from tests.profiles import searches

_MARKS = [",", ";", ".", "\n", ":", ":\n ", "(", ")"]
_OPERANDS = ["u", "v", "w", "p", "q", "wait 5 s", "do nothing"]
_WORDS = [
    "and", "or", "then", "before", "after", "otherwise", "meanwhile", "at the same time", "if that fails",
    "if that works", "if it works", "in any case", "do that", "repeat that", "again", "once more", "start over",
    "repeat everything", 'here "and" means then', "once", "as soon as", "the first time", "but stop when", "only if",
    "if possible", "for up to 5 s", "3 times", "twice", "forever", "every 5 s", "5 s apart", "2 more times",
    "wait until", "wait for", "wait up to 5 s until", "5 s later", "for 5 s", "within 5 s", "repeat", "try", "retry",
    "at 6 pm", "every day at 6 pm", "until 6 pm", "wait until 6 pm",
    "if", "unless", "while", "until", "whenever", "not", "check", "in parallel",
    "either", "both", "neither", "nor", "not both", "any of", "none of", "at least 2 of", "one of",
]  # fmt: skip
_text = st.lists(
    st.one_of(st.sampled_from(_OPERANDS), st.sampled_from(_WORDS), st.sampled_from(_MARKS)), max_size=14
).map(" ".join)


@searches(200, 100000)
@given(_text)
@example("u u \n repeat everything , forever otherwise v")
@example("if p : \n  flarp \n v . Otherwise w")
@example("repeat 3 times every 5 s")
@example("if p , if q :\n  u\n\nif p :\n  u\n\notherwise u")
def test_both_parsers_read_the_same(text: str) -> None:
    assert _reading(text, "shunting-yard") == _reading(text, "lark")


def _reading(text: str, parser: str) -> Program | list[str]:
    try:
        return read(text, parser)
    except MissionError as error:
        return [problem.code for problem in error.diagnostics]

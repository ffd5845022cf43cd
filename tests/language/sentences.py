"""Random missions over the letters vocabulary, for hypothesis.

Sentences are written in the words of `grouping_oracle.py` (`a , and b 3t NL`), so that the oracle can read them too;
`english` turns them into text.
"""

from __future__ import annotations

from hypothesis import strategies as st

_ENGLISH = {
    "a": "u", "b": "v", "c": "w", "d": "x", "e": "y",
    "3t": "3 times", "2t": "twice", "for5": "for 5 s", "within9": "within 9 s", "ifposs": "if possible",
    "every5": "every 5 s", "provided": "provided that",
}  # fmt: skip
_JOINTS = [
    "and", "or", "then", ",", "after", ", and", ", or", ", then", "otherwise", ", otherwise", ";", "before",
]  # fmt: skip

conditions = st.recursive(
    st.sampled_from("pqrs"),
    lambda inner: st.one_of(
        inner.map("not {}".format),
        inner.map("( {} )".format),
        st.tuples(inner, st.sampled_from(["and", "or", ",", ", and", ", or"]), inner).map(" ".join),
    ),
    max_leaves=4,
)


def _forms(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    heads = st.tuples(
        st.sampled_from(["if", "unless", "while", "until"]), conditions, st.sampled_from([",", "then", ":"])
    )
    prefix = heads.map(" ".join)
    after = st.one_of(
        st.sampled_from(["3t", "2t", "for5", "within9", "ifposs"]),
        st.tuples(st.sampled_from(["if", "unless", "until", "while", "provided", ", if", ", until"]), conditions).map(
            " ".join
        ),
    )
    closers = st.sampled_from(["", "3t", "until p", "while q", "for5"])
    return st.one_of(
        st.tuples(inner, st.sampled_from(_JOINTS), inner).map(" ".join),
        st.tuples(inner, after).map(" ".join),
        st.tuples(prefix, inner).map(" ".join),
        st.tuples(prefix, inner, st.sampled_from(["otherwise", ", otherwise"]), inner).map(" ".join),
        st.tuples(inner, conditions, inner).map("{0[0]} if {0[1]} otherwise {0[2]}".format),
        st.tuples(st.sampled_from(["repeat", "repeat 3t ,", "repeat until p ,", "every5 ,"]), inner, closers).map(
            " ".join
        ),
        st.tuples(st.just("try"), inner, st.sampled_from(["", "3t", "otherwise a"])).map(" ".join),
        inner.map("( {} )".format),
        st.tuples(st.sampled_from(["check", "wait until"]), conditions).map(" ".join),
    )


commands = st.recursive(st.sampled_from("abcde"), _forms, max_leaves=6)


def _blocks(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    heads = st.one_of(
        st.tuples(st.sampled_from(["if", "while", "unless"]), conditions).map(" ".join),
        st.sampled_from(["repeat", "repeat 3t", "try", "every5", "a then repeat", "if p , if q"]),
    )
    block = st.tuples(heads, st.lists(inner, min_size=1, max_size=3)).map(
        lambda drawn: f"{drawn[0]} : NL IN {' '.join(drawn[1])} DE"
    )
    otherwise = st.one_of(
        st.just(""),
        commands.map(" NL otherwise {}".format),
        st.lists(inner, min_size=1, max_size=2).map(lambda lines: f" NL otherwise : NL IN {' '.join(lines)} DE"),
    )
    return st.tuples(block, otherwise).map(lambda drawn: "".join(drawn) + " NL")


lines = st.recursive(commands.map("{} NL".format), _blocks, max_leaves=5)
missions = st.lists(lines, min_size=1, max_size=3).map(" ".join)


@st.composite
def broken_missions(draw: st.DrawFn) -> str:
    """A mission with a word lost, doubled, or put in; most of them are none any more."""
    words = draw(missions).split()
    at = draw(st.integers(0, len(words) - 1))
    if words[at] in ("NL", "IN", "DE"):
        return " ".join(words)
    change = draw(st.sampled_from(["lose", "double", "add"]))
    if change == "lose":
        del words[at]
    else:
        extra = [",", "and", "then", "(", ")", "otherwise", "a", "p", "3t", "until", "if", "not", ":", "for5", "try"]
        words.insert(at, words[at] if change == "double" else draw(st.sampled_from(extra)))
    return " ".join(words)


def english(words: str) -> str:
    """The text of a mission in the oracle's words."""
    found: list[str] = []
    line: list[str] = []
    depth = 0
    for word in words.split():
        if word == "NL":
            found.append("  " * depth + " ".join(line))
            line = []
        elif word in ("IN", "DE"):
            depth += 1 if word == "IN" else -1
        else:
            line.append(_ENGLISH.get(word, word))
    return "\n".join([*found, " ".join(line)])

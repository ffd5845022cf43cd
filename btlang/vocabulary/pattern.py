"""Phrase patterns: Cucumber Expressions (https://github.com/cucumber/cucumber-expressions) and `[optional {slot}]`.

    move forward [by] [{distance}]     turn/rotate left     item(s)     pick up {object}

Written by us because the `cucumber-expressions` package only matches whole strings and takes no slot in optional text.
"""

from __future__ import annotations

import re
from contextlib import suppress
from functools import lru_cache
from itertools import product

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    Table = Mapping[str, Sequence[str]]


class Slot(Record):
    """A `{name}` in a pattern."""

    name: str


Part = str | Slot
Form = tuple[Part, ...]
"""One way to say a phrase: words in lower case and slots."""

MOST_FORMS = 500
MOST_WORDS = 50
"""Of a phrase, slots included: a trie is as deep as its longest phrase."""


class PatternError(ValueError):
    """The pattern cannot be read; the message says what to write instead."""


_PIECE = r"(?P<slot>\{[^{}]*\})|(?P<open>\[)|(?P<close>\])|(?P<text>(?:\\.|\([^()]*\)|[^\s\[\]{}\\()])+)|(?P<bad>\S)"


@lru_cache(maxsize=16_384)  # more than all phrases of a language: each load asks for them in turn, several times
def forms(pattern: str, articles: frozenset[str] = frozenset()) -> tuple[Form, ...]:
    """Every way to say the pattern, without articles, longest first. Raises PatternError."""
    ways: list[list[Form]] = [[()]]  # a stack: the innermost open `[` is the last
    for match in re.finditer(_PIECE, pattern):
        kind, piece = match.lastgroup, match.group()
        if kind == "open":
            ways.append([()])
        elif kind == "close":
            if len(ways) == 1:
                raise PatternError(f"']' without '[' in '{pattern}'")
            inner = ways.pop()
            ways[-1] = _joined(ways[-1], [*inner, ()], pattern)
        elif kind == "slot":
            name = piece[1:-1].strip()
            if not name.isidentifier():
                raise PatternError(f"a slot is one word in braces, such as {{distance}}: '{piece}' in '{pattern}'")
            ways[-1] = _joined(ways[-1], [(Slot(name),)], pattern)
        elif kind == "text":
            choices: list[Form] = [(w,) if w and w not in articles else () for w in _alternatives(piece)]
            ways[-1] = _joined(ways[-1], choices, pattern)
        else:
            raise PatternError(f"'{piece}' is not closed in '{pattern}' (write \\{piece} for the character itself)")
    if len(ways) > 1:
        raise PatternError(f"'[' without ']' in '{pattern}'")
    found = sorted(
        set(ways[0]) - {()},
        key=lambda form: (-len(form), [part if isinstance(part, str) else f"{{{part.name}" for part in form]),
    )
    if not found or () in ways[0]:
        raise PatternError(f"the phrase '{pattern}' has no required word")
    return tuple(found)


def ways(patterns: Iterable[str], articles: frozenset[str] = frozenset()) -> Iterator[str]:
    """Every way to say patterns, in words; none of a pattern that is no pattern."""
    for pattern in patterns:
        with suppress(PatternError):
            yield from map(spelled, forms(pattern, articles))


def spelled(form: Form) -> str:
    """A form as people would write it, its slots as {name}."""
    return " ".join(part if isinstance(part, str) else f"{{{part.name}}}" for part in form)


def name_form(name: str) -> Form:
    """The form of a defined name with parameters, `greet {someone}`, in which no other character means anything."""
    return tuple(Slot(word[1:-1]) if word[0] == "{" and len(word) > 2 else word for word in name.split())


def replaced(form: Form, table: Table) -> Iterator[Form]:
    """The form with other words in place of one that the table has."""
    for at, part in enumerate(form):
        for words in table.get(part, ()) if isinstance(part, str) else ():
            yield (*form[:at], *words.split(), *form[at + 1 :])


def variants(form: Form, negations: Table, negative_subjects: Table, plurals: Table) -> Iterator[tuple[Form, str]]:
    """Further forms of a condition, each with what it says: "condition", "negated" or "negated_twice"."""
    yield from ((negated, "negated") for negated in replaced(form, negations))
    for verb in replaced(form[1:2], plurals) if isinstance(form[0], Slot) else ():
        plural = (form[0], *verb, *form[2:])
        yield plural, "condition"
        yield from ((negated, "negated") for negated in replaced(plural, negations))
    for denied in replaced(form, negative_subjects):
        yield denied, "negated"
        yield from ((twice, "negated_twice") for twice in replaced(denied, negations))


def _joined(left: list[Form], right: list[Form], pattern: str) -> list[Form]:
    joined = list(dict.fromkeys(a + b for a, b in product(left, right)))
    if any(len(form) > MOST_WORDS for form in joined):
        raise PatternError(f"'{pattern[:60]} ...' has more than {MOST_WORDS} words and slots")
    if len(joined) > MOST_FORMS:
        raise PatternError(f"'{pattern}' can be said in more than {MOST_FORMS} ways; write several phrases")
    return joined


def _alternatives(piece: str) -> list[str]:
    """`forward(s)/ahead` -> forwards, forward, ahead."""
    found = []
    for choice in re.split(r"(?<!\\)/", piece):
        if not choice:
            raise PatternError(f"an alternative is empty in '{piece}'")
        texts = [""]
        for optional, plain in re.findall(r"\(([^()]*)\)|((?:\\.|[^()\\])+)", choice):
            clean = re.sub(r"\\(.)", r"\1", plain)
            texts = [t + optional for t in texts] + texts if optional else [t + clean for t in texts]
        found += [t.lower() for t in texts]
    return found

"""What is said of conditions whose negation people read in two ways (BT151)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Token
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon


def negated_twice(text: Words, first: int, last: int, vocabulary: Lexicon) -> Diagnostic:
    """`nobody is not near`."""
    words = _written(text, first, last)
    once = _positive(words, vocabulary.negations)
    never = _positive(once, vocabulary.negative_subjects)
    return _unclear(text, first, last, " ".join(once), " ".join(never))


def negated_subjects(text: Words, first: int, last: int, vocabulary: Lexicon, before: Token | None) -> Diagnostic:
    """`Alice and Bob are not near`, and `neither Alice nor Bob is not near`."""
    positive = " ".join(_positive(_written(text, first, last), vocabulary.negations))
    if before is not None and before.kind in ("neither", "none_of"):
        positive = none = f"{text.source.text[before.start : before.end]} {positive}"
    else:
        none = f"{vocabulary.word('none_of')} {positive}"
    return _unclear(text, first, last, none, f"{vocabulary.word('not')} ({positive})")


def negated_list(text: Words, first: int, last: int, vocabulary: Lexicon) -> Diagnostic:
    """`nobody is in the lab and the kitchen`."""
    words, ands = _written(text, first, last), vocabulary.roles["and"]
    joint = max(at for at in range(first, last) if text.words[at] in ands) - first
    either = [*words[:joint], vocabulary.word("or"), *words[joint + 1 :]]
    positive = _positive(_positive(words, vocabulary.negations), vocabulary.negative_subjects)
    return _unclear(text, first, last, " ".join(either), f"{vocabulary.word('not')} ({' '.join(positive)})")


def empty_surface(text: Words, first: int, last: int, place: str, vocabulary: Lexicon) -> Diagnostic:
    """`the table is empty`."""
    entries = map(vocabulary.entry, ("SomethingIsAt", "SomeoneIsAt"))
    said = [entry.phrases[0].replace("{place}", place) for entry in entries if entry is not None]
    one, other = (f"{vocabulary.word('not')} {words}" for words in said)
    return _unclear(text, first, last, one, other)


def _unclear(text: Words, first: int, last: int, one: str, other: str) -> Diagnostic:
    span = text.span(first, last)
    return diagnostic("BT151", span, words=span.text, one=one, other=other)


def _written(text: Words, first: int, last: int) -> list[str]:
    return [text.source.text[text.starts[at] : text.ends[at]] for at in range(first, last)]


def _positive(words: list[str], table: Mapping[str, Sequence[str]]) -> list[str]:
    """The words, with the one that the table denies in place of the denial."""
    lower = [word.lower() for word in words]
    for at in range(len(words)):
        for word, denials in table.items():
            for denial in map(str.split, denials):
                if lower[at : at + len(denial)] == denial:
                    return [*words[:at], word, *words[at + len(denial) :]]
    return words


def shared_negation(
    text: Words, subject: tuple[int, int], verb: str, part: tuple[int, int], vocabulary: Lexicon
) -> Diagnostic:
    """`the battery is not low or full`: whether `not` is meant for the words `part`, too."""
    first, last = subject[0], part[1]
    before, behind = text.span(first, part[0]).text, text.span(*part).text
    written = _written(text, *subject)
    plain = _positive(written, vocabulary.negative_subjects)
    no = vocabulary.word("not")
    negated = " ".join([*written, verb]) if plain != written else no
    return _unclear(text, first, last, f"{before} {negated} {behind}", f"{before} {' '.join([*plain, verb])} {behind}")

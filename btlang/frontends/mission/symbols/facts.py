"""Finds the facts of a text before anything else is read: `the lab door is at (3, 4) facing 90 degrees`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.text.words import Words, statements
from btlang.tree.ast import Fact
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest

_OPEN, _COMMA = "(", ","


class Facts:
    """The facts of a text in order; `ends` are the words behind their statements, by the word at which these start.

    A statement that is meant as a fact but cannot be read has a problem and an end.
    """

    def __init__(self) -> None:
        self.found: list[Fact] = []
        self.ends: dict[int, int] = {}
        self.problems: list[Diagnostic] = []


def find_facts(text: Words, vocabulary: Lexicon) -> Facts:
    """Every fact of the text. Where a place is given twice both are listed; the later one counts."""
    facts = Facts()
    placing = [phrase.split() for phrase in vocabulary.roles["fact"]]
    if not any(words[0] in text.distinct for words in placing) or _OPEN not in text.distinct:
        return facts
    for _, first, last in statements(text, {_OPEN}):
        for at in range(first, last) if _OPEN in text.words[first:last] else ():
            words = next((w for w in placing if text.words[at : at + len(w)] == w), None)
            if words is not None and text.words[at + len(words)] == _OPEN:
                start = _after_politeness(text, first, at, vocabulary)
                fact = _fact(text, start, at, at + len(words), last, vocabulary)
                if fact is None:
                    example = f"door {' '.join(words)} (3, 4) {_facing(vocabulary)} 90 degrees"
                    facts.problems.append(diagnostic("BT036", text.span(start, last), example=example))
                else:
                    facts.found.append(fact)
                facts.ends[first] = last
                break
    return facts


def _fact(text: Words, start: int, is_at: int, at: int, last: int, vocabulary: Lexicon) -> Fact | None:
    """None where it is not put together as a fact is."""
    if start == is_at or not all(word[0].isalnum() for word in text.words[start:is_at]):
        return None
    point = vocabulary.values.point(text, at)
    if point is None or point[3] != last:
        return None
    name = " ".join(text.words[start:is_at])
    return Fact(name, *point[:3], text.span(start, last))


def _after_politeness(text: Words, at: int, last: int, vocabulary: Lexicon) -> int:
    while at < last:
        polite = longest(vocabulary.trie, text, at, vocabulary.context)
        if polite is None or polite.meaning.role != "politeness":
            break
        at = polite.last + (text.words[polite.last] == _COMMA)
    return at


def _facing(vocabulary: Lexicon) -> str:
    return vocabulary.roles["facing"][0]

"""Finds the missions that a text includes, before anything else of it is read: `include "kitchen.txt"`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.text.words import Words, statements
from btlang.tree.ast import Program
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.trie import longest

ROLE = "include"


class Included(Record):
    """Another mission, the names in it that stand for conditions, and the values that it names, by key."""

    mission: Program
    conditions: frozenset[str]
    known: dict[str, Known]


class Includes:
    """The paths that a text includes, each with its statement; `ends` are the words behind these, by their first."""

    def __init__(self) -> None:
        self.found: list[tuple[str, Span]] = []
        self.ends: dict[int, int] = {}


def find_includes(text: Words, vocabulary: Lexicon) -> Includes:
    """Every include of the text."""
    includes = Includes()
    firsts = {phrase.split()[0] for phrase in vocabulary.roles[ROLE]}
    if firsts.isdisjoint(text.distinct):
        return includes
    for indent, first, last in statements(text, firsts):
        match = longest(vocabulary.trie, text, first, vocabulary.context) if text.words[first] in firsts else None
        if match is None or match.meaning.role != ROLE:
            continue
        word = text.words[match.last]
        if match.last + 1 == last and word[0] == '"' and len(word) > 1 and indent == text.lines[0].indent:
            includes.found.append((word[1:], text.span(first, last)))
            includes.ends[first] = last
    return includes


def misplaced(span: Span, vocabulary: Lexicon) -> Diagnostic:
    """BT047: an include that cannot be read, or not there."""
    return diagnostic("BT047", span, words=span.text, example=f'{vocabulary.word(ROLE)} "kitchen.txt"')

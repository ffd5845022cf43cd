"""Finds the statements that go on with the one before them: `A. If that fails, B` is one statement."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.frontends.mission.symbols.phrases import Phrases
from btlang.text.words import statements
from btlang.vocabulary.language_tables import GOES_ON
from btlang.vocabulary.trie import TrieNode, longest

_OPENS_BLOCK = frozenset(("do_that", "repeat_that", "in_parallel"))  # before a colon: a statement of its own


def find_continuations(phrases: Phrases) -> set[int]:
    """The words at which such statements begin."""
    text, vocabulary = phrases.text, phrases.vocabulary
    found: set[int] = set()
    if vocabulary.continuing.isdisjoint(text.distinct):
        return found
    for _, first, last in statements(text, vocabulary.continuing):
        match = phrases.at(first) if text.words[first] in vocabulary.continuing else None
        role = match.meaning.role if match is not None else ""
        if role in GOES_ON and not (role in _OPENS_BLOCK and ":" in text.words[first:last]):
            found.add(first)
    return found


def named_at(names: TrieNode, phrases: Phrases, words: Iterable[int]) -> set[int]:
    """The words, of these, where a name begins that is at least as long as the phrase there: `once more is wave`."""
    found: set[int] = set()
    for at in words if names else ():
        name, phrase = longest(names, phrases.text, at, phrases.vocabulary.context), phrases.at(at)
        if name is not None and phrase is not None and name.last >= phrase.last:
            found.add(at)
    return found

"""Fragments of a sentence: how those of one form are put into those of another, and how they become text."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate

from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import Words, split
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import TrieNode, longest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Fragments: TypeAlias = tuple["Fragment | Fragments", ...]
else:
    Fragments = tuple

LEAF, WORD, MARK = "leaf", "word", "mark"
OPEN, CLOSE, COMMA, COLON = "(", ")", ",", ":"
_NO_SPACE_BEFORE = frozenset((CLOSE, COMMA, COLON))


class Fragment(Record):
    """A fragment; `kind` is "leaf" (may stand in brackets), "word" or "mark" (never read as a phrase)."""

    text: str
    kind: str


def mark(text: str) -> Fragment:
    """Make a punctuation mark, or words that no phrase is looked for in."""
    return Fragment(text, MARK)


def flatten(fragments: Fragments) -> Iterator[Fragment]:
    """Return the fragments in order."""
    stack: list[Any] = [fragments]
    while stack:
        item = stack.pop()
        if isinstance(item, Fragment):
            yield item
        else:
            stack.extend(reversed(item))


def is_longer(fragments: Fragments, length: float) -> bool:
    """Whether their text has surely more characters than that; much cheaper than the text."""
    return any(total > length for total in accumulate(len(fragment.text) for fragment in flatten(fragments)))


def last_fragment(fragments: Fragments) -> Fragment:
    """Return the last fragment."""
    item: Any = fragments
    while not isinstance(item, Fragment):
        item = item[-1]
    return item


def reads_on(first: Fragment, second: Fragment, vocabulary: Lexicon, names: TrieNode) -> bool:
    """Whether a connective and what stands behind it would be read as one: `once` and `every 5 s`."""
    if first.kind != WORD:
        return False
    words = split(Source(f"{first.text} {second.text}"), vocabulary.orthography)
    return _end(words, 0, vocabulary, names) > len(first.text)


def join_fragments(fragments: Fragments, vocabulary: Lexicon, names: TrieNode) -> str:
    """Join fragments to a text in which each is read as it is meant.

    Where a phrase would reach into what follows it (or a connective into it), it gets brackets, which change nothing.
    """
    given = list(flatten(fragments))
    alone: set[int] = set()
    while True:
        text, starts = _join(given, alone)
        words = split(Source(text), vocabulary.orthography)
        at = {start: i for i, start in enumerate(words.starts)}
        wrong = set()
        for i, start in starts.items():
            fragment = given[i]
            if (
                fragment.kind != MARK
                and start in at
                and _end(words, at[start], vocabulary, names) != start + len(fragment.text)
            ):
                wrong |= {i} if fragment.kind == LEAF and i not in alone else _next_leaf(given, i)
        if wrong <= alone:
            return text
        alone |= wrong


def _next_leaf(given: list[Fragment], at: int) -> set[int]:
    return {at + 1} if at + 1 < len(given) and given[at + 1].kind == LEAF else set()


def _join(given: list[Fragment], alone: set[int]) -> tuple[str, dict[int, int]]:
    """Return the text, and where each fragment starts in it; those of `alone` get brackets."""
    parts: list[str] = []
    starts: dict[int, int] = {}
    length, spaced = 0, False
    for i, fragment in enumerate(given):
        if spaced and fragment.text not in _NO_SPACE_BEFORE:
            parts.append(" ")
            length += 1
        if i in alone:
            parts.append(OPEN)
            length += 1
        starts[i] = length
        written = fragment.text + CLOSE if i in alone else fragment.text
        parts.append(written)
        length += len(written)
        spaced = fragment.text != OPEN
    return "".join(parts), starts


def _end(words: Words, at: int, vocabulary: Lexicon, names: TrieNode) -> int:
    """Return where the name or phrase that begins at a word ends."""
    lasts = [match.last for match in _matches(words, at, vocabulary, names)]
    return words.ends[max(lasts) - 1] if lasts else words.ends[at]


def _matches(words: Words, at: int, vocabulary: Lexicon, names: TrieNode) -> Iterator[Any]:
    for trie in (vocabulary.trie, names):
        match = longest(trie, words, at, vocabulary.context) if trie else None
        if match is not None:
            yield match

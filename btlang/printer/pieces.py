"""Pieces of a sentence: how those of one form are put into those of another, and how they become text.

A piece is what is read as one thing: a phrase, a name, a connective with its value, a punctuation mark. Pieces are kept
in nested tuples until the end, so that a deep tree is not copied at each level.
"""

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

    Pieces: TypeAlias = tuple["Piece | Pieces", ...]
else:
    Pieces = tuple

LEAF, WORD, MARK = "leaf", "word", "mark"
OPEN, CLOSE, COMMA, COLON = "(", ")", ",", ":"
_NO_SPACE_BEFORE = frozenset((CLOSE, COMMA, COLON))


class Piece(Record):
    """`kind` is "leaf" (may stand in brackets of its own), "word" or "mark" (never read as a phrase)."""

    text: str
    kind: str


def mark(text: str) -> Piece:
    """A punctuation mark, or words that no phrase is looked for in."""
    return Piece(text, MARK)


def flat(pieces: Pieces) -> Iterator[Piece]:
    """The pieces in order."""
    stack: list[Any] = [pieces]
    while stack:
        item = stack.pop()
        if isinstance(item, Piece):
            yield item
        else:
            stack.extend(reversed(item))


def is_longer(pieces: Pieces, length: float) -> bool:
    """Whether their text has surely more characters than that; much cheaper than the text."""
    return any(total > length for total in accumulate(len(piece.text) for piece in flat(pieces)))


def last_of(pieces: Pieces) -> Piece:
    """The last piece."""
    item: Any = pieces
    while not isinstance(item, Piece):
        item = item[-1]
    return item


def reads_on(first: Piece, second: Piece, vocabulary: Lexicon, names: TrieNode) -> bool:
    """Whether a connective and what stands behind it would be read as one: `once` and `every 5 s`."""
    if first.kind != WORD:
        return False
    words = split(Source(f"{first.text} {second.text}"), vocabulary.orthography)
    return _end(words, 0, vocabulary, names) > len(first.text)


def text_of(pieces: Pieces, vocabulary: Lexicon, names: TrieNode) -> str:
    """The text, in which each piece is read as it is meant.

    Where a phrase would reach into what follows it (or a connective into it), it gets brackets, which change nothing.
    """
    given = list(flat(pieces))
    alone: set[int] = set()
    while True:
        text, starts = _joined(given, alone)
        words = split(Source(text), vocabulary.orthography)
        at = {start: i for i, start in enumerate(words.starts)}
        wrong = set()
        for i, start in starts.items():
            piece = given[i]
            if (
                piece.kind != MARK
                and start in at
                and _end(words, at[start], vocabulary, names) != start + len(piece.text)
            ):
                wrong |= {i} if piece.kind == LEAF and i not in alone else _next_leaf(given, i)
        if wrong <= alone:
            return text
        alone |= wrong


def _next_leaf(given: list[Piece], at: int) -> set[int]:
    return {at + 1} if at + 1 < len(given) and given[at + 1].kind == LEAF else set()


def _joined(given: list[Piece], alone: set[int]) -> tuple[str, dict[int, int]]:
    """The text, and where each piece starts in it; those of `alone` get brackets."""
    parts: list[str] = []
    starts: dict[int, int] = {}
    length, spaced = 0, False
    for i, piece in enumerate(given):
        if spaced and piece.text not in _NO_SPACE_BEFORE:
            parts.append(" ")
            length += 1
        if i in alone:
            parts.append(OPEN)
            length += 1
        starts[i] = length
        written = piece.text + CLOSE if i in alone else piece.text
        parts.append(written)
        length += len(written)
        spaced = piece.text != OPEN
    return "".join(parts), starts


def _end(words: Words, at: int, vocabulary: Lexicon, names: TrieNode) -> int:
    """Where the name or phrase that begins at a word ends."""
    lasts = [match.last for match in _matches(words, at, vocabulary, names)]
    return words.ends[max(lasts) - 1] if lasts else words.ends[at]


def _matches(words: Words, at: int, vocabulary: Lexicon, names: TrieNode) -> Iterator[Any]:
    for trie in (vocabulary.trie, names):
        match = longest(trie, words, at, vocabulary.context) if trie else None
        if match is not None:
            yield match

"""The phrases in a text, each looked up once: whoever asks for one again, before the lexer or in it, gets the same."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

from btlang.text.words import END_OF_STATEMENT, Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest


class Phrases:
    """What a vocabulary alone says of a text, by word; pronouns and names of the mission are no values here.

    `fixed` are those that no value before them could make others.
    """

    def __init__(self, text: Words, vocabulary: Lexicon) -> None:
        self.text = text
        self.vocabulary = vocabulary
        self.fixed: dict[int, Match | None] = {}
        self._others: dict[int, Match | None] = {}
        self._context = ReadingContext(vocabulary.values)

    @cached_property
    def first_words(self) -> frozenset[str]:
        """Those with which statements begin."""
        words = self.text.words
        behind = (word for before, word in pairwise(words) if before == END_OF_STATEMENT)
        return frozenset((*(words[line.first] for line in self.text.lines), *behind))

    def at(self, word: int) -> Match | None:
        """The longest phrase that begins at a word."""
        for found in (self.fixed, self._others):
            if word in found:
                return found[word]
        self._context.lacked = False
        match = longest(self.vocabulary.trie, self.text, word, self._context)
        found = self._others if self._context.lacked else self.fixed
        found[word] = match
        return match

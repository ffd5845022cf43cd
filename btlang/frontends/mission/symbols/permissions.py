"""Finds what only permits something: `if you reached the lab then you may go to the hall`, `then stay there or go on`.

A robot need not do what it may do, so such a statement, or end of one, is left out, with a note.
"""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.text.words import Words, statements
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest
from btlang.vocabulary.word_tree import find, tree_of


class Permissions:
    """What a text permits: the word behind each such part, by its first, and a note about each (BT176)."""

    def __init__(self, text: Words, vocabulary: Lexicon) -> None:
        self.ends: dict[int, int] = {}
        self.problems: list[Diagnostic] = []
        firsts = vocabulary.firsts
        if text.distinct.isdisjoint(firsts["may"] | firsts["or_stay"]):
            return
        self._allowing = tree_of((phrase, True) for phrase in vocabulary.roles["may"])
        self._staying = tree_of((phrase, True) for phrase in vocabulary.roles["or_stay"])
        self._trie, self._context = vocabulary.trie, vocabulary.context.with_references()
        self._asking = firsts["if"] | firsts["once"] | firsts["arrival_at"]
        self._joining = firsts["then"] | firsts["and"]
        self._fronts = self._asking | self._joining
        self._either, self._polite = firsts["or"], firsts["politeness"]
        self._at = frozenset(words[0] for words in vocabulary.values.role_words.introducing.get("location", ()))
        for _, first, last in statements(text, {*self._allowing, *self._staying}):
            self._look(text, first, last)

    def _look(self, text: Words, first: int, last: int) -> None:
        """A whole statement that is not the first, or its last part behind a joining word."""
        words = text.words
        for at in range(first, last):
            if words[at] not in self._allowing and words[at] not in self._staying:
                continue  # as nearly always
            allows, stays = find(self._allowing, words, at), find(self._staying, words, at)
            if stays is not None and not self._stays(text, at, stays[1], last):
                stays = None  # `stay with Bob`
            if allows is None and stays is None:
                continue
            is_behind = allows is not None and allows[1] == last and words[at] in self._asking
            if stays is None and not (is_behind or self._may_begin(text, first, at)):
                continue  # `if you can see somebody`, `until you can`
            said = longest(self._trie, text, at, self._context) if stays is None else None
            if said is not None and said.meaning.entry is not None:
                continue  # `you may enter the reading corner`
            begin = first if text.words[first] in self._asking else self._begin(text, first, at)
            if begin == 0 and not is_behind:
                continue  # `you may go to the lab` asks for it
            if stays is not None and allows is None and not self._offers(text, begin, last):
                continue
            self.ends[begin] = last
            self.problems.append(diagnostic("BT176", text.span(begin, last), words=text.span(begin, last).text))
            return

    def _stays(self, text: Words, at: int, end: int, last: int) -> bool:
        """Whether `stay` at a word says where the robot is anyhow: `stay there`, `or stay in the lab`."""
        if end == last or text.words[end] == "," or text.words[end] in self._either:
            return True
        return text.words[at - 1] in self._either and text.words[end] in self._at

    def _may_begin(self, text: Words, first: int, at: int) -> bool:
        """Whether a command could begin at a word: behind a comma, a joining word, or a condition behind `if`."""
        words = text.words
        while at > first and words[at - 1] in self._polite:
            at -= 1
        if at == first or words[at - 1] == "," or words[at - 1] in self._joining:
            return True
        return self._asked(text, first, at) < at

    def _begin(self, text: Words, first: int, at: int) -> int:
        """Where the part begins that permits: behind the latest comma or `and then` before it, or the statement."""
        words = text.words
        for place in range(at - 1, first - 1, -1):
            if words[place] == "," or words[place] in self._fronts:
                return self._before_fronts(text, first, self._asked(text, first, place))
        return first

    def _before_fronts(self, text: Words, first: int, at: int) -> int:
        while at > first and (text.words[at - 1] in self._fronts or text.words[at - 1] == ","):
            at -= 1
        return at

    def _asked(self, text: Words, first: int, at: int) -> int:
        """The word behind which the condition begins that ends at a place: `and if you are in the lab then you may`."""
        for place in range(at - 1, first - 1, -1):
            for start, role in ((place + 1, "condition"), (place, "arrival_at")):
                read = longest(self._trie, text, start, self._context) if text.words[place] in self._asking else None
                if read is not None and read.last == at and read.meaning.role == role:
                    return place
        return at

    def _offers(self, text: Words, first: int, last: int) -> bool:
        """Whether `stay there` is one of two things that may be done."""
        return not self._either.isdisjoint(text.words[first:last])

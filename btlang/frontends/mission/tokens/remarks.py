"""Remarks, about which nothing is done: `I am hungry`, `there are some cups on the table`, `the cup is on the table`,
`good morning`.

A remark is only what has no verb of a command, no number, no negation and no word that is unknown.
"""

from __future__ import annotations

from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import COUNT, Parts, choice_of
from btlang.vocabulary.word_tree import find

_ENDS = (END_OF_STATEMENT, END_OF_TEXT, ",")
_KINDS = ("object", "person")


class Remarks:
    """Those of one text."""

    def __init__(self, text: Words, vocabulary: Lexicon, context: ReadingContext) -> None:
        self._text, self._vocabulary, self._context = text, vocabulary, context
        self._feeling, self._there, self._states = vocabulary.remarks
        self._very, self._be = vocabulary.asking["very"], vocabulary.asking["asking_be"]
        self._texts = vocabulary.values.texts
        self.is_possible = not text.distinct.isdisjoint(
            (*self._feeling, *self._there, *self._be)
        ) or self._texts.may_have_sayings(text)
        """Whether there may be any."""

    def end(self, at: int) -> int:
        """Where a remark that begins a statement at a word ends, 0 if there is none.

        Pronouns behind it stand for what it is about.
        """
        words = self._text.words
        saying = self._texts.end_of_saying(self._text, at)
        if saying and words[saying] in _ENDS:
            return saying
        feeling, there = find(self._feeling, words, at), find(self._there, words, at)
        if feeling is not None:
            return self._state(feeling[1])
        if there is not None:
            return self._thing(there[1], False)
        return self._thing(at, True)

    def _state(self, at: int) -> int:
        """`hungry and very tired`"""
        words = self._text.words
        while True:
            while words[at] in self._very:
                at += 1
            state = find(self._states, words, at)
            if state is None:
                return 0
            at = state[1]
            if words[at] in _ENDS:
                return at
            if words[at] not in self._vocabulary.roles["and"]:
                return 0
            at += 1

    def _thing(self, at: int, stands: bool) -> int:
        """`some cups on the table`; where it `stands` somewhere, `the cup is on the table`."""
        text, context = self._text, self._context
        at += text.words[at] in self._very
        for kind in _KINDS:
            ways = [(group, last) for group, _, last in context.sets(kind, text, at) if group]
            ways += context.ways(kind, text, at)
            for value, last in reversed(ways):
                parts, end = self._place(kind, last) if stands else ((), last)
                choice = choice_of(value)
                counts = choice is not None and COUNT in dict(choice.parts)
                if end and text.words[end] in _ENDS and (stands or choice is not None) and not counts:
                    told = choice and choice.replace(parts=tuple(sorted((*choice.parts, *parts))))
                    context.latest[kind] = told.text if told is not None else value
                    return end
        return 0

    def _place(self, kind: str, at: int) -> tuple[Parts, int]:
        """Where a thing stands, and where the words about that end; 0 if there are none."""
        context, text = self._context, self._text
        stands = at + 1 + (text.words[at + 1] in self._vocabulary.asking["standing"])
        if text.words[at] not in self._be or text.words[stands] not in context.modifiers:
            return (), 0
        behind = context.values.modifiers.behind(kind, text, stands, context.values.names_tree)
        return max(behind, key=lambda way: way[1], default=((), 0))

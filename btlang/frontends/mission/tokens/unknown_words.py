"""Words that are no phrase: how far they reach, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Set

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.definitions import Definitions
from btlang.frontends.mission.symbols.includes import ROLE as INCLUDE
from btlang.frontends.mission.symbols.includes import misplaced
from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.partial_commands import PartialCommands, may_be_doing
from btlang.frontends.mission.tokens.silent_words import MARKS, begins
from btlang.frontends.mission.tokens.word_matches import with_verb
from btlang.text.words import Words
from btlang.vocabulary.language_tables import NOT_ALONE
from btlang.vocabulary.lexicon import NODE_ROLES, Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest


class UnknownWords:
    """Those of one text, while its `tokens` are read. `verb_forms` are the words that may be forms of verbs."""

    def __init__(
        self,
        text: Words,
        vocabulary: Lexicon,
        context: ReadingContext,
        definitions: Definitions,
        partial: PartialCommands,
        tokens: list[Token],
        problems: list[Diagnostic],
        verb_forms: Set[str],
    ) -> None:
        self._text, self._vocabulary, self._context, self._definitions = text, vocabulary, context, definitions
        self._partial, self._tokens, self._problems, self._verb_forms = partial, tokens, problems, verb_forms

    def is_reported(self, start: int, end: int) -> bool:
        """Whether the latest problem is about these characters already."""
        latest = self._problems[-1].span if self._problems else None
        return latest is not None and latest.source is self._text.source and latest.start <= start and end <= latest.end

    def lack_name(self, at: int, last: int) -> bool:
        """Whether a phrase begins that only lacks a name: `without entering the kitchen`, where that is no zone.

        The words up to `last` (exclusive) are a phrase of their own.
        """
        from btlang.frontends.mission.explanations.misfits import misfits_of  # most missions have nothing to explain

        return any(each.at > last for each in misfits_of(self._text, at, (self._vocabulary.trie,), self._context))

    def why(self, at: int, end: int, match: Match | None) -> Diagnostic:
        """What is wrong with words that are no phrase, or one that stands where it cannot."""
        from btlang.frontends.mission.explanations import fragments, unknown  # most missions have nothing to explain

        role = match.meaning.role if match is not None else ""
        if match is not None and role in ("arrival", "arrival_at"):
            span = self._text.span(at, match.last)
            drives = f"goes to {match.values[0].text}" if match.values else "drives"
            return diagnostic("BT156", span, words=span.text, drives=drives)
        if match is None or role in NOT_ALONE:
            text = self._text
            if text.words[at] in self._vocabulary.roles["define"] and begins(self._tokens):
                return diagnostic("BT016", text.span(at, at + 1), word=text.words[at])
            doing = self._partial.doing(at) if text.words[at - 1] in self._vocabulary.halting else None
            if doing is not None:
                return fragments.stopped(text.span(at - 1, doing.last), self._vocabulary)
            if text.words[at] in self._verb_forms and may_be_doing(self._tokens):
                text = with_verb(text, at, self._vocabulary.doing, self._vocabulary.trie)
            return unknown.explain_unknown(
                text, at, end, self._vocabulary, self._context, self._definitions, self._tokens
            )
        if role == INCLUDE:
            return misplaced(self._text.span(at, end), self._vocabulary)
        return unknown.misread_head(self._text, at, role, self._vocabulary)

    def end(self, at: int, last: int) -> int:
        """Unknown words reach to the next mark or connective, or to a phrase that is more than one word.

        A value that nothing has the name of, and a pronoun, are read as values there: they may be another mistake.
        """
        text, context = self._text, self._context.with_references()
        context.latest = dict.fromkeys(context.types, "")
        while True:
            at += 1
            if at < last and text.words[at] == "(" and context.values.number(text, at + 1):
                return text.words.index(")", at) + 1 if ")" in text.words[at:last] else at  # meant as a point
            if at >= last or text.words[at] in MARKS:
                return at
            match = longest(self._vocabulary.trie, text, at, context)
            if match is not None and match.meaning.role in (*NODE_ROLES, *NOT_ALONE):
                continue
            if match is not None and (match.meaning.entry is None or match.last > at + 1):
                return at

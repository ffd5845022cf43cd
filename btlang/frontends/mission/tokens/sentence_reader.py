"""What readers of words that stand for commands share: the text, what is known of it, and its tokens so far."""

from __future__ import annotations

from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.calls import Calls
from btlang.frontends.mission.tokens.partial_commands import PartialCommands
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext

_ENDS = (END_OF_STATEMENT, END_OF_TEXT, ")")


class SentenceReader:
    """Reads one text while its `tokens` are made; functions that read return the word at which to go on, 0 for none."""

    def __init__(
        self,
        text: Words,
        vocabulary: Lexicon,
        context: ReadingContext,
        calls: Calls,
        partial: PartialCommands,
        tokens: list[Token],
    ) -> None:
        self._text, self._vocabulary, self._context, self._calls = text, vocabulary, context, calls
        self._partial, self._tokens = partial, tokens

    def _is_end(self, at: int) -> bool:
        """Whether a statement or bracket ends before a word."""
        return self._text.words[at] in _ENDS

    def _with_front(self, at: int, end: int, front: str) -> Match | None:
        """The phrase that words of the table `asking` make of those from `end` on."""
        return self._partial.with_front(at, end, self._vocabulary.asking[front])

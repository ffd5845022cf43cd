"""What readers of words that stand for commands share: the text, what is known of it, and its tokens so far."""

from __future__ import annotations

from collections.abc import Sequence, Set

from btlang.frontends.mission.token import Called, Listed, Token, constraint_of, drives
from btlang.frontends.mission.tokens.calls import Calls
from btlang.frontends.mission.tokens.partial_commands import PartialCommands
from btlang.text.source import Source
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.tree.answers import ANSWERED, ASK
from btlang.vocabulary.capabilities import HEARS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest

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

    def _end_of_statement(self, at: int) -> int:
        """Where the statement or bracket ends that goes on at a word."""
        while not self._is_end(at):
            at += 1
        return at

    def _phrase(self, at: int) -> Match | None:
        """The longest phrase at a word."""
        return longest(self._vocabulary.trie, self._text, at, self._context)

    def _behind_comma(self, at: int) -> int:
        """Where to go on at a word, which may be a comma."""
        return at + (self._text.words[at] == ",")

    def _with_front(self, at: int, end: int, front: str) -> Match | None:
        """The phrase that words of the table `asking` make of those from `end` on."""
        return self._partial.with_front(at, end, self._vocabulary.asking[front])

    def _journey(self, tokens: Sequence[Token] | None = None) -> Token | None:
        """The latest command that drives."""
        for token in reversed(self._tokens if tokens is None else tokens):
            if token.kind == "define":
                return None
            if token.kind == "command" and constraint_of(token) is None and drives(token.value):
                return token
        return None


def leads_to(journey: Token, place: str) -> bool:
    """Whether a command drives to a place."""
    value = journey.value
    return isinstance(value, Called) and place in [text for _, text in value.arguments]


def may_fail(token: Token) -> bool:
    """Whether a command is a task, or a name whose commands may have one."""
    value = token.value
    return token.kind == "name" or (isinstance(value, Called | Listed) and not value.entry.accompaniment)


def hears(token: Token) -> bool:
    """Whether a command waits for what somebody says."""
    return isinstance(token.value, Called | Listed) and HEARS in token.value.entry.needs


def is_question(token: Token) -> bool:
    """Whether a command asks somebody something."""
    return isinstance(token.value, Called | Listed) and token.value.entry.id == ASK


def latest_question(tokens: Sequence[Token]) -> Token | None:
    """The last command that asks somebody something."""
    return next((token for token in reversed(tokens) if is_question(token)), None)


def is_answer(token: Token) -> bool:
    """Whether a condition asks if somebody has answered in some words."""
    return isinstance(token.value, Called) and token.value.entry.id == ANSWERED


def searches(token: Token) -> bool:
    """Whether a command looks for something in one place after the other."""
    return isinstance(token.value, Called | Listed) and token.value.entry.first


def asks_for_things(tokens: Sequence[Token], source: Source, finding: Set[str]) -> bool:
    """Whether the latest condition of a statement asks whether something is found, which nothing looks for."""
    asked = next((at for at in reversed(range(len(tokens))) if tokens[at].kind == "condition"), len(tokens))
    words = (word for token in tokens[asked : asked + 1] for word in source.text[token.start : token.end].split())
    return not finding.isdisjoint(map(str.lower, words)) and not any(map(searches, tokens))


def question_in(command: Token | None) -> str:
    """Return the question that a command only says, `say "Who is there?"`, or one as an example."""
    value = command.value if command is not None else None
    said = value.arguments[-1][1] if isinstance(value, Called) and value.arguments else ""
    return said if said.endswith("?") else "Tea?"

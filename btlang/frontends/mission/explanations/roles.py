"""What is said of a role that the command before it doesn't take: `wave through the door` (BT179)."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.explanations.suggestions import without_slots
from btlang.frontends.mission.token import Called, Token
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import ways
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.value_type import WORLD
from btlang.vocabulary.word_tree import find, tree_of

_MOST_WAYS = 2
"""The ways to say a command that are shown: the shortest."""


def explain_role(
    text: Words, at: int, end: int, before: Sequence[Token], vocabulary: Lexicon, context: ReadingContext
) -> Diagnostic | None:
    """BT179 for a preposition and what follows it, right behind a command."""
    command = before[-1] if before else None
    if command is None or command.kind != "command" or not isinstance(command.value, Called):
        return None
    words = vocabulary.values.role_words
    phrases = tree_of((" ".join(phrase), role) for role, those in words.introducing.items() for phrase in those)
    introduced = find(phrases, text.words, at)
    if introduced is None or text.starts[at] < command.end:
        return None
    value = introduced[1]
    if value >= end:
        return None
    if value not in text.articles and all(context.read(kind, text, value) is None for kind in WORLD):
        return None  # `to wave`
    first = next(word for word, start in enumerate(text.starts) if start >= command.start)
    manner = find(context.manners, text.words, first)
    first = manner[1] if manner is not None else first
    has_particle = text.words[first + 1] in words.particles and first + 1 not in text.articles
    last = min(first + 1 + has_particle, at)
    span, verb, entry = text.span(at, end), text.span(first, last), command.value.entry
    taken = ", or: ".join(map(without_slots, [*ways([*entry.phrases, verb.text][:1])][-_MOST_WAYS:]))
    return diagnostic("BT179", span, verb=verb.text, words=span.text, phrase=taken)

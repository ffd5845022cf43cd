"""Whose reply a condition is about, and in which words: what stands between a question and `if she says yes`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Called, Token, statement_start
from btlang.frontends.mission.tokens.addressed_texts import TELL
from btlang.frontends.mission.tokens.sentence_reader import is_question
from btlang.text.source import Source, Span
from btlang.tree.answers import ANSWERED, PERSON_SAYS, SOMEBODY_SAYS, SPEAKS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import PERSON, TEXT

REPLIES = (PERSON_SAYS, SOMEBODY_SAYS, ANSWERED)
"""The ids of conditions about what somebody says."""
_GO_AHEAD = "go ahead"


def person_in(question: object) -> str:
    """Return the one person whom a question names, "" for none or several."""
    if not isinstance(question, Called):
        return ""
    return next(iter(question.entry.given(PERSON, question.arguments)), "")


def told_since(tokens: Sequence[Token]) -> set[str]:
    """The persons who were told something in any case since the last question, before the statement that is read."""
    found: set[str] = set()
    last = statement_start(tokens, len(tokens))
    for at in reversed(range(last)):
        if is_question(tokens[at]):
            return found
        value, first = tokens[at].value, statement_start(tokens, at)
        depends = any(token.kind in ("if", "unless", "otherwise") for token in tokens[first:at])
        if tokens[at].kind == "command" and isinstance(value, Called) and value.entry.id == TELL and not depends:
            found.add(person_in(value))
    return set()


def any_words(heard: Called, said: str, vocabulary: Lexicon) -> Called:
    """Return the condition of `Bob says something`, where nobody is asked: that he says anything at all."""
    spoken, entry = dict(heard.arguments), vocabulary.entry(SPEAKS.get(heard.entry.id, ""))
    words = "".join(heard.entry.given(TEXT, heard.arguments))
    if entry is None or words not in vocabulary.asking["unsaid"] or '"' in said:
        return heard
    return Called(entry, tuple((slot.name, spoken[slot.name]) for slot in entry.slots))


def missing_words(token: Token, source: Source, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """BT012 for `wait until Bob says so`, `if somebody calls you`, which don't say in which words."""
    value, asking, words = token.value, vocabulary.asking, Span(source, token.start, token.end)
    if isinstance(value, Called) and value.entry.id in REPLIES:
        said, _, last = words.text.rpartition(" ")
        vague = {*asking["so"], *asking["told_pronouns"], *asking["hearing"]} | vocabulary.values.role_words.speaker
        if said and last.lower() in vague and value.arguments[-1][1] == last.lower():
            example = f'{said} "{_GO_AHEAD}"'
            yield diagnostic("BT012", words, words=said, wanted="a text", example=example)

"""Pronouns that may stand for one of several people who were named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import IN_CONDITIONS, Called, Listed, Token, run_start, statement_start
from btlang.frontends.mission.tokens.hearers import persons_in
from btlang.frontends.mission.tokens.word_matches import words_of
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import PERSON

_ABOUT_IT = ("until", "while", "if", "unless")
"""Forms whose condition may be about somebody else than the command before it."""


def find_unclear_people(tokens: Sequence[Token], vocabulary: Lexicon, text: Words) -> Iterator[Diagnostic]:
    """BT151 for `wave at Alice if you see Bob. Tell her "Bye"`, `find Alice and Bob. Tell him "Bye"`: whom?

    BT038 for `go to Alice and tell her "Hi" if he is near`: he isn't Alice.
    """
    pronouns = vocabulary.pronouns_for_people
    if text.distinct.isdisjoint(pronouns):
        return  # as often
    about, asked = "", ""
    subjects = dict[str, str]()  # by the person whom they stand for
    several: tuple[str, ...] = ()
    for at, token in enumerate(tokens):
        said = _person_of(token.value)
        if isinstance(token.value, Listed):
            several = tuple(dict.fromkeys(filter(None, map(_person_of, _each(token.value)))))
        if not said:
            continue
        span = Span(text.source, token.start, token.end)
        words = words_of(text, token)
        who = [*persons_in(text, words.start, words.stop, vocabulary)]
        is_named = said.lower().split()[0] in text.words[words.start : words.stop]
        if len(who) == 1 and not is_named and who[0] not in vocabulary.values.plural_pronouns:
            if subjects.setdefault(said, who[0]) != who[0]:
                names = vocabulary.values.said_names(PERSON)
                example = next((name for name in names if name != said), said)
                yield diagnostic("BT038", span, words=who[0], type=PERSON, example=example)
        pronoun = next((word for word in span.text.lower().split() if word in pronouns), "")
        if pronoun and len(several) > 1 and said == several[-1]:
            yield diagnostic("BT151", span, words=pronoun, one=several[0], other=said)
        several = () if not pronoun else several
        if pronoun and said == asked:
            yield diagnostic("BT151", span, words=pronoun, one=about, other=asked)
            asked = ""
        elif token.kind == "command" and not pronoun:
            about, asked = said, ""
        elif token.kind == "condition" and not pronoun and about not in ("", said):
            form = run_start(tokens, at, IN_CONDITIONS) - 1
            first = statement_start(tokens, at)
            ends = form > first and tokens[form].kind in _ABOUT_IT
            asked = said if ends and any(_person_of(each.value) == about for each in tokens[first:form]) else ""


def _each(said: Listed) -> list[Called]:
    return [Called(said.entry, row) for row in said.arguments]


def _person_of(said: object) -> str:
    """The name of the person whom a phrase is about, "" for none, or for one who is chosen elsewhere."""
    if not isinstance(said, Called):
        return ""
    chosen = next(iter(said.entry.given(PERSON, said.arguments)), "")
    choice = choice_of(chosen)
    return chosen if chosen[:1] != "{" else dict(choice.parts).get(NAME, "") if choice is not None else ""

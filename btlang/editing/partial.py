"""Partial reading: what is understood of a refused text, sentence by sentence, and what may be said for the rest.

A language model rewrites what was not understood with it, and shows people how the rest is read.
"""

from __future__ import annotations

from btlang.api import Mission
from btlang.backends.explain import Sentences, understood
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.language_tables import GOES_ON, ORDER
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.listing import phrases_with
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

MOST_NAMES = 40
NO_ANTECEDENT = "BT038"
"""The code of the message about a pronoun that refers to nothing: maybe only because what it refers to is left out."""


def partial_reading(text: str, vocabulary: Lexicon, compiled: Callable[[str], Mission]) -> dict[str, Any]:
    """Return each sentence with its reading in controlled English, or with what was not understood and the phrases that
    fit.

    `compiled` compiles a text. A sentence that is refused is left out, so that the others are read without it. Raises
    MissionError for what is wrong with no sentence.
    """
    sentences = Sentences(Source(text), vocabulary)
    refused: dict[int, list[Diagnostic]] = {}
    mission: Mission | None = None
    while mission is None and len(refused) < len(sentences):
        try:
            mission = compiled(_without(text, sentences, refused))
        except MissionError as error:
            placed = [problem for problem in error.diagnostics if problem.is_error]
            numbers = {max(sentences.number(problem.span.start), 0) for problem in placed}
            if not numbers - refused.keys():
                raise
            for problem in placed:
                refused.setdefault(max(sentences.number(problem.span.start), 0), []).append(problem)
    depending = _find_depending(sentences, refused, vocabulary)
    read: dict[int, str] = {}
    if mission is not None and mission.syntax is not None:
        for each in understood(mission.syntax, mission.tree, mission.vocabulary, sentences):
            read[each.number] = f"{read[each.number]}\n{each.english}" if each.number in read else each.english
    return {
        "ok": not refused,
        "sentences": [
            _depends(number, sentences)
            if number in depending
            else _sentence(number, sentences, read, refused, vocabulary)
            for number in range(len(sentences))
        ],
        "names": {
            kind: list(vocabulary.values.listed(kind))[:MOST_NAMES] for kind in WORLD if kind in vocabulary.types
        },
    }


def _find_depending(sentences: Sentences, refused: dict[int, list[Diagnostic]], vocabulary: Lexicon) -> set[int]:
    """Return the sentences that go on with one that is refused, or may speak of its things: `it` would be something
    else.
    """
    found: set[int] = set()
    for number in range(1, len(sentences)):
        own = {problem.code for problem in refused.get(number, ())}
        if own <= {NO_ANTECEDENT} and (number - 1 in refused or number - 1 in found):
            text = split(Source(sentences.written(number)[1]), vocabulary.orthography)
            match = longest(vocabulary.trie, text, 0, vocabulary.context)
            goes_on = match is not None and match.meaning.role in (*GOES_ON, *ORDER)
            if goes_on or not vocabulary.values.pronouns.keys().isdisjoint(text.words):
                found.add(number)
    return found


def _depends(number: int, sentences: Sentences) -> dict[str, Any]:
    line, written = sentences.written(number)
    reason = {"words": written, "message": "It depends on the sentence before it, which isn't understood."}
    return {"line": line, "text": written, "understood": False, "not_understood": [reason], "forms": []}


def _without(text: str, sentences: Sentences, refused: dict[int, list[Diagnostic]]) -> str:
    """Return the text with blanks in the place of some sentences, so that all others stay where they are."""
    for number in refused:
        start, end = sentences.reach(number)
        blank = "".join(character if character.isspace() else " " for character in text[start:end])
        text = text[:start] + blank + text[end:]
    return text


def _sentence(
    number: int,
    sentences: Sentences,
    read: dict[int, str],
    refused: dict[int, list[Diagnostic]],
    vocabulary: Lexicon,
) -> dict[str, Any]:
    line, written = sentences.written(number)
    said: dict[str, Any] = {"line": line, "text": written, "understood": number not in refused}
    if number in refused:
        problems = refused[number]
        said["not_understood"] = [{"words": problem.span.text, "message": problem.message} for problem in problems]
        said["forms"] = phrases_with(vocabulary, written)
    elif number in read:
        said["reading"] = read[number]
    else:
        said["note"] = "it asks for nothing, or belongs to the sentence before it"
    return said

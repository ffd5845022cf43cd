"""What a message suggests: phrases like the words, examples about the world, and what else a robot can do."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from btlang.frontends.mission.token import Token
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.tree.answers import SOMEBODY_SAYS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import forms, spelled
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE, TEXT
from btlang.vocabulary.verbs import canonical
from btlang.vocabulary.word_tree import find

_LONGEST_NAME, _LONGEST_CLAUSE, _LONGEST_SHOWN = 4, 20, 200
"""The words up to which what isn't known may be the name of a command, or a clause, and the characters of either."""


def nearest_known(words: Iterable[str]) -> str:
    """Return the advice that lists what was probably meant."""
    return "Similar: " + ", ".join(map(without_slots, words))


def without_slots(phrase: str) -> str:
    """Return a way to say a phrase with dots in the place of its slots."""
    return re.sub(r"\{\w+\}", "...", phrase)


def example_commands(vocabulary: Lexicon) -> list[str]:
    """Return up to three commands about what there is in the world, in the words of a vocabulary."""
    found: list[str] = []
    for kind in (PLACE, OBJECT, "person"):
        names = vocabulary.values.said_names(kind) if kind in vocabulary.types else []
        entries = (entry for entries in vocabulary.entries.values() for entry in entries if entry.verbs)
        ways = (forms(canonical(verbs[0], roles[:1])) for entry in entries for verbs, roles in entry.verbs[:1]
                if roles and roles[0].type == kind and not any(role.is_needed for role in roles[1:]))  # fmt: skip
        said = next((spelled(way[0]) for way in ways), "") if names else ""
        found += [re.sub(r"\{\w+\}", names[0], said)] if said else []
    return found


def examples(vocabulary: Lexicon, sort: str) -> str:
    """Return the advice with three commands, or conditions, about what there is in the world."""
    found: list[str] = []
    for kind in (OBJECT, "person", "door") if sort == "condition" else ():
        names = vocabulary.values.said_names(kind) if kind in vocabulary.types else []
        asking = (entry for entries in vocabulary.entries.values() for entry in entries if entry.sort == "condition")
        said = next((way for entry in asking for way in entry.phrases[:1] if re.findall(r"{(\w+)}", way) == [kind]), "")
        found += [re.sub(r"\{\w+\}", names[0], said)] if said and names else []
    found = found or example_commands(vocabulary)
    return f"I understand for example: {'; '.join(found)}" if found else "'btc words' lists what I know."


def heard(text: Words, at: int, end: int, vocabulary: Lexicon) -> str:
    """Return the advice that somebody may say what no sensor reports, "" where the words are no clause."""
    says = next((phrase for entry in vocabulary.entries.get(SOMEBODY_SAYS, ()) for phrase in entry.phrases), "")
    said = Span(text.source, text.begin(at), text.span(at, end).end).text
    is_clause = 1 < end - at <= _LONGEST_CLAUSE and len(said) <= _LONGEST_SHOWN
    texts, people = vocabulary.values.texts, vocabulary.values.names_tree(PERSON)
    is_of_person = text.words[at] in texts.of_persons or find(people, text.words, at) is not None
    if (
        not says
        or not is_clause
        or is_of_person
        or not all(word[0].isalpha() or word[0] == "'" for word in text.words[at:end])
    ):
        return ""
    condition = spelled(forms(says, vocabulary.articles)[0]).replace(f"{{{TEXT}}}", f'"{said}"')
    return f"If the robot is only to listen for somebody who says so, write: {condition}"


def defined(text: Words, at: int, end: int, before: Sequence[Token], vocabulary: Lexicon) -> str:
    """Return the advice to define words as a command, "" where they hardly name what is done."""
    words, texts = text.words[at:end], vocabulary.values.texts
    goes_on = bool(before) and before[-1].kind in ("command", "condition")
    is_name = 1 < len(words) <= _LONGEST_NAME and all(word.isalnum() and not texts.asks(word) for word in words)
    states = not texts.of_persons.isdisjoint(words[:1]) or not texts.inverting.isdisjoint(words)
    is_name = is_name and not states and sum(map(len, words)) <= _LONGEST_SHOWN
    if goes_on or not is_name or not vocabulary.values.role_words.prepositions.isdisjoint(words):
        return ""
    return f"To teach it, define it first: {text.span(at, end).text} is ..."

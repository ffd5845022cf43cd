"""The words of a language around verbs: prepositions, synonyms, particles, and words that say nothing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from btlang.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class RoleWords(Record):
    """The words of a language around verbs."""

    introducing: Mapping[str, tuple[tuple[str, ...], ...]]
    synonyms: Mapping[str, tuple[str, ...]]
    particles: frozenset[str]
    fillers: frozenset[str]
    speaker: frozenset[str]
    directions: frozenset[str]


def role_words(language: Mapping[str, Any]) -> RoleWords:
    """The words of the tables of a language."""

    def split_all(phrases: Iterable[str]) -> tuple[tuple[str, ...], ...]:
        return tuple(tuple(phrase.split()) for phrase in phrases)

    return RoleWords(
        {role: split_all(phrases) for role, phrases in language["prepositions"].items()},
        {verb: tuple(verbs) for verb, verbs in language["synonyms"].items()},
        frozenset(language["particles"]),
        frozenset(language["fillers"]),
        frozenset(language["speaker"]),
        frozenset(language["directions"]),
    )

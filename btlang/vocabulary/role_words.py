"""The words of a language around verbs: prepositions, synonyms, particles, and words that say nothing."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence

from btlang.support.record import Record
from btlang.vocabulary.entry import PATH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class RoleWords(Record):
    """The words of a language around verbs."""

    introducing: Mapping[str, tuple[tuple[str, ...], ...]]
    prepositions: frozenset[str]  # the first words of all of these
    synonyms: Mapping[str, tuple[str, ...]]
    particles: frozenset[str]
    fillers: frozenset[str]
    speaker: frozenset[str]
    directions: frozenset[str]
    ends: frozenset[str]
    way_starts: frozenset[str]
    longer: tuple[tuple[str, ...], ...]

    def introduces(self, words: Sequence[str], at: int) -> int:
        """How many words at a place come before what fills a role or describes a thing, 0 for one: `next to`."""
        return max((len(phrase) for phrase in self.longer if tuple(words[at : at + len(phrase)]) == phrase), default=0)

    def is_one_elsewhere(self, words: Sequence[str], last: int, ones: Container[str]) -> bool:
        """Whether words with `one` before a place say what goes there: `... and another one in the hall`."""
        return words[last - 1] in ones and (words[last],) in self.introducing.get("goal", ())

    def ends_at(self, words: Sequence[str], at: int) -> bool:
        """Whether no phrase goes on at a word; `to the lab, going through the hall` goes on at the comma."""
        return words[at] in self.ends and not (words[at] == "," and words[at + 1] in self.way_starts)


def role_words(language: Mapping[str, Any], describing: frozenset[str]) -> RoleWords:
    """The words of the tables of a language; `describing` are those with which what describes a thing may begin."""

    def split_all(phrases: Iterable[str]) -> tuple[tuple[str, ...], ...]:
        return tuple(tuple(phrase.split()) for phrase in phrases)

    introducing = {role: split_all(phrases) for role, phrases in language["prepositions"].items()}
    relations = map(split_all, language["relations"].values())
    prepositions = frozenset(phrase[0] for phrases in introducing.values() for phrase in phrases)
    going_on = {*prepositions, *language["particles"], *language["fillers"], *describing}
    firsts = {role: {phrase.split()[0] for phrase in phrases} for role, phrases in language["roles"].items()}
    going_on |= firsts.get("except", set()) - firsts.get("but", set())
    return RoleWords(
        introducing,
        prepositions,
        {verb: tuple(verbs) for verb, verbs in language["synonyms"].items()},
        frozenset(language["particles"]),
        frozenset(language["fillers"]),
        frozenset(language["speaker"]),
        frozenset(language["directions"]),
        frozenset((",", ";", ":", ")", "\n", *(set().union(*firsts.values()) - going_on))),
        frozenset(phrase[0] for phrase in introducing.get(PATH, ()) if len(phrase) > 1),
        tuple(phrase for phrases in (*introducing.values(), *relations) for phrase in phrases if len(phrase) > 1),
    )

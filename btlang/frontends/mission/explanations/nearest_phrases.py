"""The phrases that words may have been meant as: those that begin like them but for spelling."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import takewhile

from btlang.frontends.mission.explanations.spelling_rule import is_respelling
from btlang.text.spelling import nearest_start
from btlang.vocabulary.language_tables import NOT_ALONE
from btlang.vocabulary.lexicon import NODE_ROLES, Lexicon
from btlang.vocabulary.pattern import forms, spelled

_NOT_OFFERED = NOT_ALONE | {
    *NODE_ROLES, "never", "called", "with", "giving", "node", "newline", "character", "main_name", "given",
    "needs_world", "needs_words", "needs_robot", "set_to", "by", "add_to", "subtract_from", "remember_as", "each_in",
    "all_names", "except", "may", "or_stay",
}  # fmt: skip
"""Roles that say nothing alone or are for texts that programs write: what is like their words was hardly meant so."""
_LEAST_LIKE, _MARK = 60, 3
"""How near the first word of a phrase has to be, of 100, and how many letters of it its pattern has to have."""


@lru_cache(maxsize=256)  # mistakes repeat
def nearest_phrases(all_written: tuple[str, ...], vocabulary: Lexicon, names: tuple[str, ...]) -> list[tuple[str, int]]:
    """Phrases and names that may have been meant, each with the number of words that stand for it; one of each id."""
    written = list(takewhile(lambda word: word[0].isalpha(), all_written))  # a value stands for no word
    if not written:
        return []
    phrases = {name: (name, name.split()) for name in names} | _phrases(vocabulary, written)
    found = nearest_start(written, {key: start for key, (_, start) in phrases.items()})
    near = [key for key in found if _begins_like(written, phrases[key][1], vocabulary)]
    best = {phrases[key][0]: key for key in reversed(near)}
    return [(key, len(phrases[key][1])) for key in near if best[phrases[key][0]] == key][:3]


def _phrases(vocabulary: Lexicon, written: Sequence[str]) -> dict[str, tuple[str, list[str]]]:
    """What can be said that may begin as what was written, as people would write it: its id, and the words up to the
    first slot; each such start once.
    """
    from rapidfuzz import fuzz, process

    firsts, patterns = _first_words(vocabulary)
    near = process.extract(written[0], firsts, scorer=fuzz.ratio, score_cutoff=_LEAST_LIKE, limit=None)
    whole = "".join(written)
    marks = {word[:_MARK] for word in (*(word for word, _, _ in near), *filter(whole.startswith, firsts))}
    known: dict[tuple[str, ...], tuple[str, str]] = {}
    for id, pattern in patterns:
        if any(mark in pattern for mark in marks):
            for start, said in _starts(pattern, vocabulary.articles):
                known.setdefault(start, (said, id))
    return {said: (id, list(start)) for start, (said, id) in known.items() if start}


@lru_cache(maxsize=4)  # a text full of unknown words asks for them at each
def _first_words(vocabulary: Lexicon) -> tuple[list[str], list[tuple[str, str]]]:
    """The words with which anything begins, and the patterns of all that is offered, each with its id."""
    entries = [(entry.id, entry.phrases) for entries in vocabulary.entries.values() for entry in entries]
    roles = ((role, patterns) for role, patterns in vocabulary.roles.items() if role not in _NOT_OFFERED)
    firsts = [word for word in vocabulary.trie if isinstance(word, str)]
    return firsts, [(id, pattern) for id, patterns in (*entries, *roles) for pattern in patterns]


@lru_cache(maxsize=8192)
def _starts(pattern: str, articles: frozenset[str]) -> list[tuple[tuple[str, ...], str]]:
    """The ways to say a pattern: the words up to the first slot, and all of them; the shortest first."""
    return [
        (tuple(str(part) for part in takewhile(lambda part: isinstance(part, str), form)), spelled(form))
        for form in reversed(forms(pattern, articles))
    ]


def _begins_like(written: list[str], start: list[str], vocabulary: Lexicon) -> bool:
    """Whether the first words are the same but for spelling: `lookaround` and `look around`, too."""
    if not (written and start):
        return False
    first, joined = written[0], "".join(start)
    pairs = (first, start[0]), (first, joined), ("".join(written), joined)
    return any(one == other or is_respelling(one, other, vocabulary) for one, other in pairs)

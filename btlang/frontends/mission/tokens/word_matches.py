"""Phrases that words of a text make side by side, some of them replaced: the forms of verbs, and words left out."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence

from btlang.frontends.mission.token import Token
from btlang.text.words import END_OF_TEXT, Words
from btlang.vocabulary.entry import THEME
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import TrieNode, longest
from btlang.vocabulary.value_type import WORLD

DOING = frozenset(("command", "name", "wait", "wait_until", "wait_for", "wait_up_to"))
"""The kinds of commands whose verb may have another form."""
_MOST_WORDS = 60


def theme_of(match: Match) -> SlotValue | None:
    """What a command is about, None where that is a list, or isn't said."""
    entry = match.meaning.entry
    if entry is None or match.meaning.role != "command":
        return None
    slots = entry.slots_of(THEME)
    values = [value for value in match.values if value.type in WORLD and (value.name in slots or not entry.verbs)]
    return values[0] if len(values) == 1 and not (values[0].more and not values[0].group) else None


def words_of(text: Words, token: Token) -> range:
    """The words of a token."""
    return token.words or range(bisect_left(text.starts, token.start), bisect_left(text.starts, token.end))


def doing(
    text: Words,
    at: int,
    endings: Mapping[str, Sequence[str]],
    tries: Sequence[TrieNode],
    context: ReadingContext,
) -> Match | None:
    """The command whose verb has this form: `going to the lab`."""
    found: Match | None = None
    places = list(rest_of(text, at))
    for verb in _verbs(text.words[at], endings):
        match = match_of(text, places, {0: verb}, tries, context)
        if match is not None and match.meaning.role in DOING and (found is None or match.last > found.last):
            found = match
    return found and relocated(found, places)


def with_verb(text: Words, at: int, endings: Mapping[str, Sequence[str]], trie: TrieNode) -> Words:
    """The same text with the verb itself in place of its form, where a phrase begins with that."""
    verb = next((verb for verb in _verbs(text.words[at], endings) if verb in trie), text.words[at])
    return text.with_word(at, verb)


def _verbs(word: str, endings: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """The verbs that may have this form."""
    for ending, bare in endings.items():
        if word.endswith(ending) and word != ending:
            yield from (word[: -len(ending)] + end for end in bare)


def forms_of(verb: str, endings: Mapping[str, Sequence[str]]) -> list[str]:
    """The forms that a verb may have with these endings: `closes` of `close`."""
    return [verb.removesuffix(end) + form for form, ends in endings.items() for end in ends if verb.endswith(end)]


def rest_of(text: Words, at: int) -> range:
    """The words of the line from one on, with what ends it."""
    last = at
    while text.words[last] != END_OF_TEXT and last < at + _MOST_WORDS:
        last += 1
    return range(at, last)


def match_of(
    text: Words, places: Sequence[int], other: Mapping[int, str], tries: Sequence[TrieNode], context: ReadingContext
) -> Match | None:
    """The longest phrase of words of a text side by side, some of them replaced."""
    read = Words(text.source)
    read.picked = text, places
    for number, place in enumerate(places):
        read.words.append(other.get(number, text.words[place]))
        if place in text.articles:
            read.articles[number] = text.articles[place]
    read.starts, read.ends = [text.starts[place] for place in places], [text.ends[place] for place in places]
    end = places[-1] + 1
    for _ in range(2):  # as behind each text
        read.words.append(END_OF_TEXT)
        read.starts.append(text.ends[end - 1])
        read.ends.append(text.ends[end - 1])
    found = [
        longest(trie, read, 0, context, names) for trie, names in zip(tries, (*tries[1:], *tries[:1]), strict=True)
    ]
    return max((match for match in found if match is not None), key=lambda match: match.last, default=None)


def relocated(match: Match, places: Sequence[int]) -> Match:
    """A match in such words as one in their text."""
    values = tuple(value.replace(first=places[value.first], last=places[value.last - 1] + 1) for value in match.values)
    moved: Match = match.replace(last=places[match.last - 1] + 1, values=values)
    return moved

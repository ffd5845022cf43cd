"""Days before a text is read: `on Mondays and on Fridays` is one list, `on Mondays wave at 9 am` has its hour first."""

from __future__ import annotations

from btlang.frontends.mission.tokens.each_and_any import ENDING, STOPS
from btlang.text.time_of_day import WEEKDAYS, WEEKEND, WORKDAYS
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest
from btlang.vocabulary.word_tree import find

_DAILY = ("on_days", "weekly", "every_day")
_GROUPS = {"weekdays": [WEEKDAYS[day] for day in WORKDAYS], "weekends": [WEEKDAYS[day] for day in WEEKEND]}


def list_days(text: Words, vocabulary: Lexicon) -> None:
    """Say days as one list: `on Mondays and on Fridays`, and `every day except Sunday` by the names of the others."""
    words, values, tree = text.words, vocabulary.values, vocabulary.values.names_tree("days")
    if text.distinct.isdisjoint(tree):
        return  # as nearly always
    on, joints = vocabulary.firsts["on_days"], {",", *vocabulary.roles["and"]}
    times = {phrase.split()[0] for phrase in vocabulary.roles["at"]}
    for at in reversed([at for at in range(2, len(words) - 1) if words[at] in on and words[at - 1] in joints]):
        is_listed = find(tree, words, at - 2 - (words[at - 2] == ",")) is not None
        if is_listed and find(tree, words, at + 1) is not None:
            text.drop(at, at + 1)
    for at in reversed([at for at in range(len(words)) if words[at] in vocabulary.any_day]):
        found = find(vocabulary.any_day, words, at)
        first = found[1] if found is not None else at
        if words[first] in times:  # `every day at 9 am except on Sundays`
            until = next(i for i in range(first, len(words)) if words[i] in ENDING)
            first = next((i for i in range(first, until) if values.exception(text, i)), first)
        end = values.exception(text, first) if found is not None else 0
        left_out, last = set[str](), 0
        end += bool(end) and words[end] in on
        while end and (day := find(tree, words, end)) is not None:
            left_out.update(_GROUPS.get(day[0], day[:1]))
            last, end = day[1], day[1] + (words[day[1]] in joints)
        others = [day for day in WEEKDAYS if day not in left_out]
        if found is not None and left_out and len(others) > 1:
            text.drop(first, last)
            text.drop(at, found[1] - 1)
            listed = [word for day in others for word in (",", day.lower())]
            every = vocabulary.asking["any_day"][0].split()[:1]
            text.replace(at, [*every, *listed[1:-2], vocabulary.word("and"), listed[-1]])


def say_hour_first(text: Words, vocabulary: Lexicon) -> None:
    """Put the hour of a first command behind the days: `on Mondays wave at 9 am`, `every day wave at noon`."""
    if text.distinct.isdisjoint((*vocabulary.values.names_tree("days"), *vocabulary.any_day)):
        return  # as nearly always
    words, fronts = text.words, _fronts(vocabulary)
    for first in reversed(
        [at for at, word in enumerate(words) if word in fronts and (not at or words[at - 1] in STOPS)]
    ):
        last = _end_of_days(text, first, vocabulary)
        begin = last + (words[last] == ",")
        ends = (at for at in range(begin, len(words)) if words[at] in ENDING or words[at] in vocabulary.joining)
        hours = (at for at in range(begin + 1, next(ends, 0)) if _role(text, at, vocabulary) == "at")
        hour = next(hours, 0) if last else 0
        match = longest(vocabulary.trie, text, hour, vocabulary.context) if hour else None
        if match is not None and not _names_days(text, match.last, vocabulary):
            said = [words[last - 1], *words[hour : match.last], ","]
            text.drop(hour, match.last)
            text.drop(last, begin)
            text.replace(last - 1, said)


def _names_days(text: Words, at: int, vocabulary: Lexicon) -> bool:
    """Whether other days are named in the statement that goes on at a word: `..., on Saturdays at 9`."""
    end = next(place for place in range(at, len(text.words)) if text.words[place] in STOPS)
    return any(_end_of_days(text, i, vocabulary) or _role(text, i, vocabulary) in _DAILY for i in range(at, end))


def _end_of_days(text: Words, first: int, vocabulary: Lexicon) -> int:
    """Where days end that begin at a word, without an hour beside them; 0 for other words."""
    words, joints, tree = text.words, {",", *vocabulary.roles["and"]}, vocabulary.values.names_tree("days")
    any_day = find(vocabulary.any_day, words, first)
    if any_day is not None:
        return any_day[1] if _role(text, first, vocabulary) != "every_day" else 0
    last, day = 0, find(tree, words, first + 1)
    while day is not None:
        last = day[1]
        day = find(tree, words, last + 1) if words[last] in joints else None
    return last if last and _role(text, first, vocabulary) not in _DAILY else 0


def _fronts(vocabulary: Lexicon) -> set[str]:
    """The words with which days begin a statement."""
    phrases = (phrase for role in ("on_days", "weekly") for phrase in vocabulary.roles[role])
    return {*vocabulary.any_day, *(word for phrase in phrases for word in phrase.split()[0].split("/"))}


def _role(text: Words, at: int, vocabulary: Lexicon) -> str:
    match = longest(vocabulary.trie, text, at, vocabulary.context)
    return match.meaning.role if match is not None else ""

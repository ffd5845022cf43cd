"""Why words are no time of day, or why one cannot stand there."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import chain

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Called, Token
from btlang.text.source import Source, Span
from btlang.text.words import Words
from btlang.tree.rounds import DAYTIME
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import SlotValue
from btlang.vocabulary.value_type import PLACE

_TIME, _DAYS = "time_of_day", "days"
MIDNIGHT = "00:00"
"""Where a day begins."""
_NOWHERE = "is a time of day, and fits nothing that I understood around it"
_SENTENCE_END = re.compile(r"[.!?;](?=\s)|\n")
_USUAL = "6:30 pm, or 18:30"
_BESIDE_MARK = re.compile(r"(?<=\d)\s*[:.]\s*(?=\d)")


def explain_time(text: Words, at: int, wanted: bool, vocabulary: Lexicon) -> Diagnostic | None:
    """BT160 for words like a time of day where none is read; None for others. `wanted`: one must stand there."""
    values, words = vocabulary.values, text.words
    time, number = values.time_of_day(text, at), values.number(text, at)
    if time is not None:
        if words[at].isalpha() and number is None:
            return None  # `noon` is also a plain word
        span = text.span(at, time[1])
        example = f"{vocabulary.word('at')} {span.text}, wave"
        return _problem(span, _NOWHERE, example)
    if ":" in words[at] and words[at][0].isdecimal():
        half = values.half_of_day(text, at + 1)
        return _problem(text.span(at, half[1] if half else at + 1), "isn't a time of day", _USUAL)
    if number is None:
        return None
    end = number[1]
    span, half = text.span(at, end), values.half_of_day(text, end)
    if half is not None:
        return _problem(text.span(at, half[1]), "isn't a time of day", "1 pm, or 13:00")
    if not wanted:
        return None
    last = end + 2 if words[end] == ":" and words[end + 1].isdecimal() else end
    half = values.half_of_day(text, last)
    whole = text.span(at, half[1] if half else last)
    joined = _BESIDE_MARK.sub(":", whole.text)
    if vocabulary.value("time_of_day", joined) is not None:
        return _problem(whole, "isn't a time of day: it needs a ':' without blanks", joined, (whole, joined))
    clock = values.clock(text, at)
    if clock is None or not 0 <= clock[0] < 24 or clock[0] % 1:
        return _problem(span, "isn't a time of day", _USUAL)
    hour, minutes, end = clock
    span = text.span(at, end)
    halves = values.halves_of_day if 1 <= hour <= 12 else []
    ways = ", or ".join((*(f"{span.text} {half}" for half in halves), f"{int(hour)}:{minutes or 0:02}"))
    return _problem(span, "isn't a time of day: it needs am, pm or a ':'", ways)


def without_misled_times(problems: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Leave out that a time can't stand where it does, if something else in its sentence isn't understood."""

    def misleads(time: Diagnostic) -> bool:
        others = (each.span for each in problems if each.is_error and each.span.start > time.span.end)
        return _NOWHERE in time.message and any(
            other.source is time.span.source
            and _SENTENCE_END.search(other.source.text, time.span.end, other.start) is None
            for other in others
        )

    return [problem for problem in problems if not misleads(problem)]


def assumed_times(text: Words, values: Sequence[SlotValue]) -> Iterator[Diagnostic]:
    """BT140 for each time of which only what stands beside it says whether it is in the morning; BT251 where nothing
    does.
    """
    for value in values:
        if value.type == _TIME:
            yield from assumed_between(text, value.first, value.last)


def assumed_between(text: Words, first: int, last: int) -> Iterator[Diagnostic]:
    """The same for the times among some words."""
    for at in (at for at in range(first, last) if at in text.assumed):
        time, end, beside = text.assumed[at]
        span = text.span(at, end)
        if beside is None:
            yield _either_half(span, time)
            continue
        which = "the next such time after" if beside.start < span.start else "the last such time before"
        yield diagnostic("BT140", span, words=span.text, time=time, which=which, before=beside.text)


def _either_half(span: Span, time: str) -> Diagnostic:
    """BT251 for `5:30` alone."""
    other = f"{(int(time[:2]) + 12) % 24:02}{time[2:]}"
    am, pm = (f"{span.text} {half}" for half in ("am", "pm"))
    problem = diagnostic("BT251", span, words=span.text, time=time, other=other, am=am, pm=pm)
    return problem.replace(readings=((span, am), (span, pm)))  # type: ignore[no-any-return]


def without_hour(text: Words, at: int, end: int, vocabulary: Lexicon) -> Diagnostic | None:
    """BT160 for a part of the day without an hour among words: `until the morning`, `during the night`."""
    values = vocabulary.values
    days = values.read(_DAYS, text, at + 1) if _DAYS in values.types else None
    phrases = chain(vocabulary.roles["on_days"], vocabulary.roles["weekly"])
    on_days = {word for phrase in phrases for word in phrase.split()[0].split("/")}
    if days is not None and text.words[at] in on_days:
        span = text.span(at, days[1])
        time = explain_time(text, days[1] + 1, True, vocabulary)
        if time is not None:
            return time  # `on Mondays at 9`
        return _problem(span, "says no hour", f"{span.text} {vocabulary.word('at')} 9 am")
    places = (i for i in range(at, min(end + 1, len(text.words))) if text.words[i] in values.parts_of_day)
    place = next((i for i in places if i in text.articles or text.words[i - 1] in vocabulary.quantifiers), None)
    if place is None or values.time_of_day(text, place) is not None:
        return None  # `good morning Alice` is something to say
    return _problem(text.span(place, place + 1), "says no hour", _USUAL)


def find_midnights(tokens: Sequence[Token], source: Source) -> Iterator[Diagnostic]:
    """BT160 for a bound at midnight alone: every time of a day is after it, and none before."""
    for token in tokens:
        said = token.value if token.kind == "condition" else None
        if isinstance(said, Called) and said.entry.id == DAYTIME and [time for _, time in said.arguments] == [MIDNIGHT]:
            span = Span(source, token.start, token.end)
            is_late = said.arguments[0][0] in ("below", "at_most")
            problem = f"says no span of a day, as {'none' if is_late else 'all'} of it is so"
            yield _problem(span, problem, f"between {'10 pm and midnight' if is_late else 'midnight and 6 am'}")


def _problem(span: Span, problem: str, example: str, fix: tuple[Span, str] | None = None) -> Diagnostic:
    return diagnostic("BT160", span, fix=fix, words=span.text, problem=problem, example=example)


def lasting(wait: Span, vocabulary: Lexicon) -> Diagnostic:
    """BT012 for a wait that doesn't say how long, nor that the robot stays there."""
    there = "".join(pronouns_for(vocabulary.values.pronouns, PLACE, alone=True)[:1])
    example = f"{wait.text} {vocabulary.word('for')} {vocabulary.types['duration'].example}, or: {wait.text} {there}"
    return diagnostic("BT012", wait, words=wait.text, wanted="a duration", example=example)

"""Words of texts about times, read from left to right: times of day, durations, weekdays and dates."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from datetime import date

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.frontends.mission.explanations.times import explain_time
from btlang.task.schedule.calendar import MONTHS, ORDINAL_ENDINGS, ORDINALS, YEARS
from btlang.text.source import Source, Span
from btlang.text.spelling import respellings
from btlang.text.time_of_day import DAY, EVERY_DAY, WEEKDAYS, WEEKEND, WORKDAYS, seconds_of
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, split
from btlang.vocabulary.load import load_vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    T = TypeVar("T")


DURATION = "duration"
_SHORT_DAYS = {"tues": 1, "thur": 3, "thurs": 3}
_SINGULAR = {
    **{name.lower(): (number,) for number, name in enumerate(WEEKDAYS)},
    **{name[:3].lower(): (number,) for number, name in enumerate(WEEKDAYS)},
    **{name: (number,) for name, number in _SHORT_DAYS.items()},
    "weekday": WORKDAYS,
    "workday": WORKDAYS,
    "weekend": WEEKEND,
}
_PLURAL = {f"{name}s": days for name, days in _SINGULAR.items() if "day" in name or "end" in name}  # not `Tues`
_DAY_UNITS = {"day": 1, "days": 1, "week": 7, "weeks": 7}
_MONTHS = {
    **{name.lower(): number for number, name in enumerate(MONTHS, 1)},
    **{name[:3].lower(): number for number, name in enumerate(MONTHS, 1)},
    "sept": 9,
}
_DATES = "24 December 2026, or 2026-12-24"
UNKNOWN = "isn't understood here"
_LONGEST_HINT = 60  # characters of a text to which a hint adds words


class Unread(Exception):
    """A text that isn't what is wanted, since `what` is at `span` and has a `problem`. It was read up to the word with
    the number `reached`. `example` is what to write; `fix` is a change that mends the text.
    """

    def __init__(
        self,
        span: Span,
        problem: str,
        reached: int,
        example: str = "",
        what: str = "",
        fix: tuple[Span, str] | None = None,
    ) -> None:
        super().__init__(problem)
        self.span, self.problem, self.reached, self.example, self.fix = span, problem, reached, example, fix
        self.what = what or f"'{span.text}'"
        self.expected: Collection[str] = ()
        """Words that are understood at the span; () if the problem isn't a single word."""


class ScheduleWords:
    """A text and the number of its next word, `at`. What is asked for is read, and `at` moves behind it; if it isn't
    there, the answer is None and `at` stays. Words that can only be a mistake raise Unread.
    """

    def __init__(self, source: Source) -> None:
        self._vocabulary = load_vocabulary()
        self._values = self._vocabulary.values
        self._text = split(source, self._vocabulary.orthography)
        self.source = source
        self.at = 0
        self._last = len(self._text.words)
        while self._last and self._text.words[self._last - 1] in (",", END_OF_STATEMENT, END_OF_TEXT):
            self._last -= 1
        self._asked: dict[int, set[str]] = {}
        self._value_words = frozenset(word for tree in self._values.word_trees() for word in tree if word.isalpha())
        lost = sorted((*self._text.unreadable, *self._text.comments), key=lambda span: span.start)
        if lost:
            raise Unread(lost[0], UNKNOWN, 0)

    @property
    def is_over(self) -> bool:
        """Return whether all words are read."""
        return self.at >= self._last

    def ahead(self, by: int = 0) -> str:
        """Return a word that isn't read yet, by its distance."""
        return self._text.words[self.at + by] if self.at + by < self._last else END_OF_TEXT

    def ends_with(self, word: str) -> bool:
        """Return whether that is the last word, and isn't read yet."""
        return self.at < self._last and self._text.words[self._last - 1] == word

    @property
    def parts_of_day(self) -> Collection[str]:
        """The words of `every morning at 8`."""
        return self._values.parts_of_day

    def takes(self, *phrases: str) -> str:
        """Return the phrase that is next, behind which it reads on; "" if none of them is."""
        return next((phrase for phrase in phrases if self._takes(phrase.split())), "")

    def _takes(self, words: list[str]) -> bool:
        for by, word in enumerate(words):
            self._asked.setdefault(self.at + by, set()).add(word)
            if self.ahead(by) != word:
                return False
        self.at += len(words)
        return True

    def choice(self, table: Mapping[str, T]) -> T | None:
        """Read the next word by a table, and return what that has for it."""
        self._asked.setdefault(self.at, set()).update(table)
        found = table.get(self.ahead())
        self.at += found is not None
        return found

    def read_list(self, item: Callable[[], T | None], *openers: str, goes_on: bool = False) -> list[T]:
        """Read a list: what a function reads again and again, with commas or `and` between, and with or without one of
        some words before it. With `goes_on` the first one of the list is read already.
        """
        found: list[T] = []
        while True:
            before = self.at
            if (found or goes_on) and not self.takes(", and", ",", "and"):
                return found
            self.takes(*openers)
            one = item()
            if one is None:
                self.at = before
                return found
            found.append(one)

    def exception(self) -> bool:
        """Read `except`, `but not` and so on."""
        end = 0 if self.is_over else self._values.exception(self._text, self.at)
        self._asked.setdefault(self.at, set()).add("except")
        self.at = end or self.at
        return bool(end)

    def time_of_day(self) -> int | None:
        """Read `14:30`, `9 am` or `noon`, and return seconds since midnight."""
        self._asked.setdefault(self.at, set()).update(self._value_words)
        found = None if self.is_over else self._values.time_of_day(self._text, self.at)
        if found is None:
            return None
        self.at = found[1]
        return int(seconds_of(found[0]))

    def need_time(self) -> int:
        """Read a time of day. Raises Unread if the next words are none."""
        time = self.time_of_day()
        if time is not None:
            return time
        explained = None if self.is_over else explain_time(self._text, self.at, True, self._vocabulary)
        if explained is None:
            raise self.unknown("9:00, 9 am or noon")
        arguments = dict(explained.arguments)
        raise Unread(explained.span, arguments["problem"], self.at, arguments["example"], fix=explained.fix)

    def read_listed_time(self) -> int | None:
        """Read a time of day in a list. Raises Unread for one or two figures that aren't one, nor a day."""
        time, first = self.time_of_day(), self.at
        if time is None and re.match(r"\d\d?\b", self.ahead()):
            if self.calendar_date() is None and self.ordinal() is None:
                self.need_time()
            self.at = first
        return time

    def hour(self) -> tuple[int, bool] | None:
        """Read a bare hour such as `10`, or a time of day; return seconds since midnight, and whether it is bare."""
        time = self.time_of_day()
        if time is not None:
            return time, False
        first, found = self.at, self.number()
        if found in range(25):
            return int(found or 0) % 24 * 3600, True
        self.at = first
        return None

    def number(self) -> float | None:
        """Read a number in figures or words."""
        self._asked.setdefault(self.at, set()).update(self._value_words)
        found = None if self.is_over else self._values.number(self._text, self.at)
        if found is None:
            return None
        self.at = found[1]
        return found[0]

    def says_half(self, first: int) -> bool:
        """Return whether there is an `am` or `pm` among the words that are read from one on."""
        halves = self._values.halves_of_day
        return any(word in halves for word in self._text.words[first : self.at])

    def duration(self) -> float | None:
        """Read a duration, and return seconds. Raises Unread if a number has no unit of time behind it."""
        self._asked.setdefault(self.at, set()).update(self._value_words)
        found = None if self.is_over else self._values.quantity(self._text, self.at, (DURATION,))
        if found is not None and found[1] == DURATION:
            self.at = found[2]
            return found[0]
        first, number = self.at, self.number()
        if number is None:
            return None
        units = {word for unit in self._values.types[DURATION].units for word in unit.words}
        self._asked.setdefault(self.at, set()).update(units)
        is_fraction = not float(number).is_integer() and self._text.words[first].isalpha()
        example = "15 minutes" if is_fraction else f"{self.since(first).text} minutes"
        if self.is_over:
            raise self.wrong("needs a unit of time", first, example)
        if self.ahead() in units:  # and yet it's no quantity
            self.at += 1
            raise self.wrong("is too long", first, "10 minutes")
        raise self.unknown(example)

    def days(self) -> int | None:
        """Read whole days: `10 days`, `a week`."""
        first = self.at
        count = 1 if first in self._text.articles else self.number()
        length = None if count is None else self.choice(_DAY_UNITS)
        if count is None or length is None or not float(count * length).is_integer():
            self.at = first
            return None
        return int(count * length)

    def weekdays(self) -> tuple[tuple[int, ...], bool] | None:
        """Read weekdays, and whether they are said so that every week is meant: `Mondays`, `weekdays`, `Monday to
        Friday`, but not `Monday`.
        """
        first, bar, last = self.ahead().partition("-")
        if bar and first in _SINGULAR and last in _SINGULAR:
            self.at += 1
            return _from_to(_SINGULAR[first], _SINGULAR[last]), True
        found = self.choice(_PLURAL)
        plural = found is not None
        found = found or self.choice(_SINGULAR)
        if found is None:
            return None
        if self.ahead() in ("to", "through", "till", "until") and self.ahead(1) in (_SINGULAR.keys() | _PLURAL.keys()):
            self.at += 1
            last_days = self.choice(_PLURAL) or self.choice(_SINGULAR)
            assert last_days is not None
            return _from_to(found, last_days), True
        return found, plural

    def ordinal(self) -> int | None:
        """Read `first`, `1st`, `last` (-1)."""
        found = self.choice(ORDINALS)
        if found is None and self.ahead().isdecimal() and self.ahead(1) in ORDINAL_ENDINGS and len(self.ahead()) < 3:
            found = int(self.ahead())
            self.at += 2
        return found

    def calendar_date(self) -> tuple[int, int, int] | None:
        """Read year (0 if it isn't said), month and day: `2026-12-24`, `24 December 2026`, `December 24`, `the 24th of
        December`. Raises Unread for a day that the calendar doesn't have.
        """
        first = self.at
        found = self._date_in_figures() or self._date_in_words()
        if found is None:
            self.at = first
            return None
        year, month, day = found
        try:
            date(year or 2000, month, day)  # which has a 29 February
        except ValueError:
            raise self.wrong("isn't a date", first, _DATES) from None
        if year and year not in YEARS:
            raise self.wrong(f"isn't a date from {YEARS[0]} to {YEARS[-1]}", first, _DATES)
        return found

    def _date_in_figures(self) -> tuple[int, int, int] | None:
        written = self._text.source.text[self._text.starts[self.at] :] if not self.is_over else ""
        figures = re.match(r"(\d{4})-(\d\d?)-(\d\d?)(?!\.?\w)", written, re.ASCII)
        if figures is None:
            return None
        self.at += 3
        return int(figures[1]), int(figures[2]), int(figures[3])

    def _date_in_words(self) -> tuple[int, int, int] | None:
        month = self.choice(_MONTHS)
        day = self.ordinal() or self._figures(1, 2)
        if month is None and day is not None:
            self.takes("of")
            month = self.choice(_MONTHS)
        if month is None or day is None:
            return None
        if self.ahead() == "," and len(self.ahead(1)) == 4 and self.ahead(1).isdecimal():
            self.at += 1
        return self._figures(4) or 0, month, day

    def _figures(self, *lengths: int) -> int | None:
        """Return a number of so many figures."""
        word = self.ahead()
        if not word.isdecimal() or len(word) not in lengths:
            return None
        self.at += 1
        return int(word)

    def since(self, first: int) -> Span:
        """Return the words from one on that are read."""
        return self._text.span(first, max(self.at, first + 1))

    def wrong(self, problem: str, first: int, example: str = "") -> Unread:
        """Make the error to raise: what is wrong with the words from one on that are read."""
        return Unread(self.since(first), problem, self.at, example)

    def incomplete(self, problem: str, *more: str) -> Unread:
        """Make the error to raise: what the whole text lacks, which the further words would mend."""
        if not self._last:
            return Unread(Span(self.source, 0, 0), "is empty", 0, what="The text")
        span = self._text.span(0, self._last)
        shown = more and len(span.text) <= _LONGEST_HINT
        return Unread(span, problem, self._last, f"{span.text} {' '.join(more)}" if shown else "")

    def whole(self, problem: str, example: str) -> Unread:
        """Make the error to raise: what is wrong with the whole text, and what to write for all of it."""
        return Unread(self._text.span(0, self._last), problem, self._last, example)

    def unknown(self, example: str) -> Unread:
        """Make the error to raise: the next word isn't understood, or one behind it that was looked at, or the text has
        ended.
        """
        if self.is_over:
            return self.incomplete("isn't complete")
        farthest = max((at for at in self._asked if at < self._last), default=self.at)
        at = max(self.at, farthest)  # in `of evry month` the mistake isn't `of`
        unread = Unread(self._text.span(at, at + 1), UNKNOWN, at, example)
        if self._text.words[at] not in self._value_words:  # `every hundred hours` has no misspelt word
            unread.expected = self._asked.get(at, ())
        return unread


def _from_to(first: tuple[int, ...], last: tuple[int, ...]) -> tuple[int, ...]:
    """Return the weekdays from the first to the last, which may be in the next week."""
    days = [(first[0] + more) % 7 for more in range((last[-1] - first[0]) % 7 + 1)]
    return tuple(day for day in EVERY_DAY if day in days)


def read_length(source: Source) -> float | None:
    """Return the seconds of a text that is a length of time and nothing else: `5 minutes`, `1 h 30 min`, `2 days`."""
    seconds = 0.0
    with suppress(Unread):
        words = ScheduleWords(source)
        while not words.is_over:
            days = words.days()
            more = words.duration() if days is None else days * DAY
            if more is None:
                return None
            seconds += more
            words.takes("and")
        return seconds or None
    return None


_CAPITAL = {name.lower(): name for name in (*WEEKDAYS, *(f"{name}s" for name in WEEKDAYS), *MONTHS)}
_CLEAR = 4  # letters of a word that may be a correction even if the text still can't be read
_LONGEST_WORD = 40  # letters; nobody mistypes a longer one


def read_text(text: str, name: str, example: str, read: Callable[[ScheduleWords], T]) -> T:
    """Return what a function makes of the words of a text.

    `name` is what messages call the text; Unread becomes MissionError (BT194), with a correction of the spelling where
    one helps, or else an example.
    """
    source = Source(re.sub(r"[\r\n]", " ", text), name)
    try:
        return read(ScheduleWords(source))
    except Unread as unread:
        similar = _correction(unread, read)
        fix = (unread.span, similar) if similar else unread.fix
        advice = f"Similar: {similar}" if similar else f"Write for example: {unread.example or example}"
        raise MissionError([
            diagnostic("BT194", unread.span, fix=fix, what=unread.what, problem=unread.problem, advice=advice)
        ]) from None  # fmt: skip


def _correction(unread: Unread, read: Callable[[ScheduleWords], object]) -> str:
    """Return the word with which the text can be read, or else read on; "" where none is near."""
    span, farther = unread.span, ""
    if not span.text.isalpha() or len(span.text) > _LONGEST_WORD:
        return ""
    for word in respellings(span.text.lower(), unread.expected):
        shown = _CAPITAL.get(word, word)
        try:
            read(ScheduleWords(Source(span.source.text[: span.start] + shown + span.source.text[span.end :])))
        except Unread as other:
            farther = farther or (shown if other.reached > unread.reached and len(word) >= _CLEAR else "")
            continue
        return shown
    return farther

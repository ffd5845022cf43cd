"""When schedules are due: rules in English such as `every day at 9:00`, in a time zone; and single points in time.

Times are those of a clock on the wall in the zone. A time that the clock skips, as summer time begins, comes as much
later as the gap is long: 2:30 becomes 3:30. A time that comes twice, as summer time ends, counts once, the first time.
Intervals begin again each day, at the start of their window or else at midnight, and count elapsed time. Both ends of
a window are in it; a window may cross midnight, and then belongs to the day on which it begins.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import suppress
from datetime import date, datetime, timedelta
from functools import partial

from btlang.diagnostics.diagnostic import MissionError
from btlang.support.record import Record
from btlang.task.schedule.calendar import Days, Rule, day_of, moment_of, read_zone
from btlang.task.schedule.rules import EXAMPLE, read_rule_in
from btlang.task.schedule.words import UNKNOWN, ScheduleWords, Unread, read_length, read_text
from btlang.text.time_of_day import DAY

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import ClassVar

_BEFORE = timedelta(days=3)
"""A window may last into the next day, and a gap of the clock may be a day long."""
_DAY = int(DAY)
_FARTHEST = 366 * DAY
_BACK = (10, 366 * 9)
"""The days to look back: where the first ones have no time, it's one of each year, or a 29 February."""
_MOMENT = "tomorrow at 9:00"
_PAST_MOMENT = "yesterday at 9:00"


def read_rule(text: str, zone: str = "") -> Recurrence:
    """Return what a rule such as `on weekdays at 14:30` means in a time zone such as `Europe/Berlin`; "" is that of the
    computer. docs/schedules.md has all forms. Raises MissionError (BT194) for another text, and for an unknown zone.
    """
    read_zone(zone)
    return Recurrence(read_text(text, "<schedule>", EXAMPLE, partial(_read_rule, zone)), zone)


def _read_rule(zone: str, words: ScheduleWords) -> Rule:
    try:
        return read_rule_in(words)
    except Unread as unread:
        text = words.source.text
        if unread.problem != UNKNOWN or not _is_moment(text, zone):
            raise
    raise words.whole("is a single time, not a schedule", f'btc task add MISSION --at "{text}"')


def _is_moment(text: str, zone: str) -> bool:
    with suppress(MissionError):
        read_moment(text, time.time(), zone)
        return True
    return False


class Recurrence(Record):
    """The times of a rule in a zone, "" for that of the computer. All times are in seconds since 1970."""

    rule: Rule
    zone: str = ""

    def next(self, after: float) -> float | None:
        """Return the first time strictly after a moment; None if it never comes again."""
        return next(self._after(after), None)

    def last(self, until: float) -> float | None:
        """Return the last time that isn't after a moment; None if none of these years has one."""
        for days in _BACK:
            found = list(self.between(until - days * DAY, until))
            if found:
                return max(found)
        return None

    def between(self, start: float, end: float) -> Iterator[float]:
        """Yield the times after `start` and not after `end`, in order."""
        for moment in self._after(start):
            if moment > end:
                return
            yield moment

    def __str__(self) -> str:
        """Write canonical English, without the zone: `read_rule` makes an equal Recurrence of it."""
        return str(self.rule)

    def _after(self, start: float) -> Iterator[float]:
        """Yield all times from a moment on, in order.

        Where the clock skips midnight, times of one day may come after times of the next.
        """
        zone = read_zone(self.zone)
        found: set[float] = set()
        for day in self.rule.days.since(day_of(start, zone) - _BEFORE):
            begin = moment_of(day, 0, zone, earliest=True)
            yield from sorted(moment for moment in found if moment < begin)
            found = {moment for moment in found if moment >= begin}
            found.update(moment for moment in self._of(day) if moment > start)
        yield from sorted(found)

    def _of(self, day: date) -> Iterator[float]:
        zone, rule = read_zone(self.zone), self.rule
        if not rule.interval:
            yield from (moment_of(day, time, zone) for time in rule.times)
            return
        begin, end = rule.window or (0, _DAY)
        first, last = moment_of(day, begin, zone), moment_of(day, end if end > begin else end + _DAY, zone)
        moment = first
        while moment < last or (rule.window and moment in (first, last)):  # a gap may put the first behind the last
            yield moment
            moment += rule.interval


def read_moment(text: str, now: float, zone: str = "") -> float:
    """Return a point in time such as `14:30` (the next such time), `Monday at 9 am`, `24 December at noon` or `in 10
    minutes`, in seconds since 1970. It may be in the past only if the text says `today`, or a date with its year.

    Raises MissionError (BT194) for another text, and for an unknown zone.
    """
    read_zone(zone)
    return read_text(text, "<time>", _MOMENT, lambda words: _Moment(words, now, zone).moment())


def read_past_moment(text: str, now: float, zone: str = "") -> float:
    """Read a moment as `read_moment` does, but of times that have passed: `14:30` is the last such time; `2 hours ago`,
    `yesterday at 9:00`. Raises MissionError (BT194) also for a time that is still to come.
    """
    read_zone(zone)
    return read_text(text, "<time>", _PAST_MOMENT, lambda words: _PastMoment(words, now, zone).moment())


class _Moment:
    """A reader of one point in time."""

    example = _MOMENT
    named: ClassVar[dict[str, int]] = {"today": 0, "tomorrow": 1}
    """The days that have a name, by their distance from today."""
    openers: ClassVar[tuple[str, ...]] = ("on",)
    otherwise = "is in the past"
    away = "in {}"
    """How to say a moment by its distance from now."""

    def __init__(self, words: ScheduleWords, now: float, zone: str) -> None:
        self.words, self.now, self.zone = words, now, zone

    def moment(self) -> float:
        """Return the seconds since 1970. Raises Unread."""
        try:
            return self._read()
        except Unread:
            if read_length(self.words.source) is None:
                raise
        example = self.away.format(self.words.source.text.strip())
        raise self.words.whole("is a length of time, not a time", example)

    def _read(self) -> float:
        words = self.words
        if words.takes("now"):
            moment = self.now
        else:
            relative = self.relative()
            if relative is None:
                return self._day_and_time()
            moment = relative
        if not words.is_over:
            raise words.unknown(self.example)
        return moment

    def relative(self) -> float | None:
        """Read `in 10 minutes`; None if the text isn't of that kind."""
        return self.shift(1, "in 10 minutes") if self.words.takes("in") else None

    def shift(self, sign: int, example: str, end: str = "") -> float:
        """Move a time by so much: `10 minutes`, `1 h 30 min`, `2 days`, up to a word at the end.

        Days are those of the clock on the wall.
        """
        words = self.words
        first, days, seconds = words.at, 0, 0.0
        while True:
            more_days = words.days()
            more = words.duration() if more_days is None else 0.0
            if more is None:
                raise words.unknown(example if words.at == first else example.replace("10", "1 hour and 30"))
            days, seconds = days + (more_days or 0), seconds + more
            if words.is_over or (end and words.takes(end)):
                break
            words.takes("and")
        if not 0 <= days * DAY + seconds <= _FARTHEST:
            raise words.wrong("is more than a year" if days * DAY + seconds > 0 else self.otherwise, first, example)
        if not days:
            return self.now + sign * seconds
        zone = read_zone(self.zone)
        wall = datetime.fromtimestamp(self.now, zone)
        time = wall.hour * 3600 + wall.minute * 60 + wall.second
        there = moment_of(wall.date() + sign * timedelta(days), time, zone)
        return there + wall.microsecond / 1e6 + sign * seconds

    def _day_and_time(self) -> float:
        """Read a day and a time in either order; without a day the nearest such time."""
        words = self.words
        days: Days | None = None
        time: int | None = None
        while not words.is_over:
            if words.takes(","):
                continue
            first = words.at
            found = words.need_time() if words.takes("at") else words.read_listed_time()
            day = self._day() if found is None else None
            if (found is not None and time is not None) or (day is not None and days is not None):
                raise words.wrong(f"is a second {'time' if day is None else 'day'}", first)
            time, days = (time if found is None else found), day or days
        if time is None:
            raise words.incomplete("doesn't say at what time", "at 9:00")
        if days is not None and days.single and days.single[0]:
            return self.check(moment_of(date(*days.single), time, read_zone(self.zone)))
        moment = self.nearest(Recurrence(Rule(days or Days(), (time,)), self.zone))
        if moment is None:
            raise words.incomplete("never comes again")
        return moment

    def _day(self) -> Days:
        """Read one day, or several that mean the nearest of them."""
        words = self.words
        words.takes(*self.openers)
        first, named = words.at, words.takes(*self.named)
        if named:
            day = day_of(self.now, read_zone(self.zone)) + timedelta(days=self.named[named])
            return Days(single=(day.year, day.month, day.day))
        single = words.calendar_date()
        if single is not None:
            return Days(single=single)
        weekdays = words.weekdays()
        if weekdays is None:
            raise words.unknown(self.example)
        if weekdays[1] or len(weekdays[0]) > 1:
            raise words.wrong("isn't one day", first, "Monday at 9:00")
        return Days(weekdays[0])

    def nearest(self, recurrence: Recurrence) -> float | None:
        """Choose the one that is meant of times that come again."""
        return recurrence.next(self.now)

    def check(self, moment: float) -> float:
        """Check a time on a day that is said. Raises Unread if it can't be meant."""
        return moment


class _PastMoment(_Moment):
    example = _PAST_MOMENT
    named: ClassVar[dict[str, int]] = {"yesterday": -1, "today": 0, "tomorrow": 1}
    openers: ClassVar[tuple[str, ...]] = ("on last", "last", "on")
    otherwise = "is still to come"
    away = "{} ago"

    def relative(self) -> float | None:
        return self.shift(-1, "10 minutes ago", "ago") if self.words.ends_with("ago") else None

    def nearest(self, recurrence: Recurrence) -> float | None:
        return recurrence.last(self.now)

    def check(self, moment: float) -> float:
        if moment > self.now:
            raise self.words.wrong(self.otherwise, 0)
        return moment

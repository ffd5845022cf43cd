"""When schedules are due: rules in English such as `every day at 9:00`, in a time zone; and single points in time.

Times are those of a clock on the wall in the zone. A time that the clock skips, as summer time begins, comes as much
later as the gap is long: 2:30 becomes 3:30. A time that comes twice, as summer time ends, counts once, the first time.
Intervals begin again each day, at the start of their window or else at midnight, and count elapsed time. Both ends of
a window are in it; a window may cross midnight, and then belongs to the day on which it begins.
"""

from __future__ import annotations

from collections.abc import Iterator
from datetime import date, timedelta

from btlang.record import Record
from btlang.task.days import Days
from btlang.task.rule import Rule
from btlang.task.rule_reader import EXAMPLE, read_rule_in
from btlang.task.schedule_text import read_text
from btlang.task.schedule_words import ScheduleWords
from btlang.task.time_zones import day_of, moment_of, read_zone
from btlang.text.time_of_day import DAY

_BEFORE = timedelta(days=3)
"""A window may last into the next day, and a gap of the clock may be a day long."""
_DAY = int(DAY)
_FARTHEST = 366 * DAY
_MOMENT = "tomorrow at 9:00"


def read_rule(text: str, zone: str = "") -> Recurrence:
    """What a rule such as `on weekdays at 14:30` means in a time zone such as `Europe/Berlin`; "" is that of the
    computer. docs/schedules.md has all forms. Raises MissionError (BT194) for another text, and for an unknown zone.
    """
    read_zone(zone)
    return Recurrence(read_text(text, "<schedule>", EXAMPLE, read_rule_in), zone)


class Recurrence(Record):
    """The times of a rule in a zone, "" for that of the computer. All times are in seconds since 1970."""

    rule: Rule
    zone: str = ""

    def next(self, after: float) -> float | None:
        """The first time strictly after a moment; None if it never comes again."""
        return next(self._after(after), None)

    def between(self, start: float, end: float) -> Iterator[float]:
        """Those after `start` and not after `end`, in order."""
        for moment in self._after(start):
            if moment > end:
                return
            yield moment

    def __str__(self) -> str:
        """Canonical English, without the zone: `read_rule` makes an equal Recurrence of it."""
        return str(self.rule)

    def _after(self, start: float) -> Iterator[float]:
        """All of them, in order. Where the clock skips midnight, times of one day may come after times of the next."""
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
    """A point in time such as `14:30` (the next such time), `Monday at 9 am`, `24 December at noon` or `in 10 minutes`,
    in seconds since 1970. It may be in the past only if the text says `today`, or a date with its year.

    Raises MissionError (BT194) for another text, and for an unknown zone.
    """
    read_zone(zone)
    return read_text(text, "<time>", _MOMENT, lambda words: _moment(words, now, zone))


def _moment(words: ScheduleWords, now: float, zone: str) -> float:
    if words.takes("now"):
        moment = now
    elif words.takes("in"):
        moment = now + _delay(words)
    else:
        return _day_and_time(words, now, zone)
    if not words.is_over:
        raise words.unknown(_MOMENT)
    return moment


def _delay(words: ScheduleWords) -> float:
    """Seconds: `10 minutes`, `1 h 30 min`."""
    first, seconds = words.at, words.duration()
    if seconds is None:
        raise words.unknown("in 10 minutes")
    while not words.is_over:
        words.takes("and")
        more = words.duration()
        if more is None:
            raise words.unknown("in 1 hour and 30 minutes")
        seconds += more
    if not 0 <= seconds <= _FARTHEST:
        raise words.wrong("is more than a year" if seconds > 0 else "is in the past", first, "in 10 minutes")
    return seconds


def _day_and_time(words: ScheduleWords, now: float, zone: str) -> float:
    """In either order; without a day the next such time."""
    days: Days | None = None
    time: int | None = None
    while not words.is_over:
        if words.takes(","):
            continue
        first = words.at
        found = words.needed_time() if words.takes("at") else words.listed_time()
        day = _day(words, now, zone) if found is None else None
        if (found is not None and time is not None) or (day is not None and days is not None):
            raise words.wrong(f"is a second {'time' if day is None else 'day'}", first)
        time, days = (time if found is None else found), day or days
    if time is None:
        raise words.incomplete("doesn't say at what time", "at 9:00")
    if days is not None and days.single and days.single[0]:
        return moment_of(date(*days.single), time, read_zone(zone))
    moment = Recurrence(Rule(days or Days(), (time,)), zone).next(now)
    if moment is None:
        raise words.incomplete("never comes again")
    return moment


def _day(words: ScheduleWords, now: float, zone: str) -> Days:
    """One day, or days of which the next one is meant."""
    words.takes("on")
    first, named = words.at, words.takes("today", "tomorrow")
    if named:
        day = day_of(now, read_zone(zone)) + timedelta(days=named == "tomorrow")
        return Days(single=(day.year, day.month, day.day))
    single = words.calendar_date()
    if single is not None:
        return Days(single=single)
    weekdays = words.weekdays()
    if weekdays is None:
        raise words.unknown(_MOMENT)
    if weekdays[1] or len(weekdays[0]) > 1:
        raise words.wrong("isn't one day", first, "Monday at 9:00")
    return Days(weekdays[0])

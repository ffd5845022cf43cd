"""The calendar of schedules: days, time zones, rules for the clock on the wall, and moments as people read them."""

from __future__ import annotations

from calendar import monthrange
from collections.abc import Iterator
from datetime import date, datetime, time, timedelta
from time import localtime, strftime
from zoneinfo import ZoneInfo, available_timezones

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.support.record import Record
from btlang.text.formatting import NTH, joined, nth
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest
from btlang.text.time_of_day import EVERY_DAY, WEEKDAYS, WEEKEND, WORKDAYS, shown

MONTHS = (
    "January", "February", "March", "April", "May", "June",
    "July", "August", "September", "October", "November", "December",
)  # fmt: skip
LAST = -1
"""The last day of a month, or the last such weekday in it."""
YEARS = range(1970, 3000)
"""A date in another year is surely a slip."""

_SMALL = (
    "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth", "eleventh",
    "twelfth", "thirteenth", "fourteenth", "fifteenth", "sixteenth", "seventeenth", "eighteenth", "nineteenth",
    "twentieth",
)  # fmt: skip
ORDINALS = {
    **{word: number for number, word in enumerate(_SMALL, 1)},
    **{f"twenty-{word}": 20 + number for number, word in enumerate(_SMALL[:9], 1)},
    "thirtieth": 30,
    "thirty-first": 31,
    "last": LAST,
}
ORDINAL_ENDINGS = (*NTH.values(), "th")
"""The endings behind the figures of an ordinal number."""


class Days(Record):
    """The days of `weekdays` (0 is Monday), or only the first, second and so on of them in each month (`which`); or the
    `month_days` of each month, which it may lack; or one `single` date: year (0: every year), month and day.
    """

    weekdays: tuple[int, ...] = EVERY_DAY
    which: tuple[int, ...] = ()
    month_days: tuple[int, ...] = ()
    single: tuple[int, ...] = ()

    def __contains__(self, day: date) -> bool:
        if self.single:
            return self.single in ((0, day.month, day.day), (day.year, day.month, day.day))
        last = monthrange(day.year, day.month)[1]
        if self.month_days:
            return day.day in self.month_days or (LAST in self.month_days and day.day == last)
        if day.weekday() not in self.weekdays:
            return False
        return not self.which or (day.day + 6) // 7 in self.which or (LAST in self.which and day.day + 7 > last)

    def since(self, first: date) -> Iterator[date]:
        """Yield the days from a day on, to the end of `YEARS`."""
        begin = max(first, date(YEARS[0], 1, 1))
        if self.single and self.single[0]:
            begin = max(begin, date(*self.single))
            end = date(*self.single)
        else:
            end = date(YEARS[-1], 12, 31)
        for number in range(begin.toordinal(), end.toordinal() + 1):
            day = date.fromordinal(number)
            if day in self:
                yield day

    def __str__(self) -> str:
        if self.single:
            year, month, day = self.single
            return f"on {day} {MONTHS[month - 1]} {year}" if year else f"on {day} {MONTHS[month - 1]} of every year"
        if self.month_days:
            days = joined([nth(day) for day in self.month_days])
            return f"on the {days}{' day' if LAST in self.month_days else ''} of every month"
        if self.which:
            which = joined([nth(number) for number in self.which])
            return f"on the {which} {WEEKDAYS[self.weekdays[0]]} of every month"
        named = {EVERY_DAY: "every day", WORKDAYS: "on weekdays", WEEKEND: "on weekends"}
        left = [WEEKDAYS[day] for day in EVERY_DAY if day not in self.weekdays]
        if self.weekdays not in named and len(left) == 1:
            return f"every day except on {left[0]}s"
        return named.get(self.weekdays) or "on " + joined([f"{WEEKDAYS[day]}s" for day in self.weekdays])


_LONGEST = 80  # characters of a name that may be a misspelling
_EXAMPLE = "Europe/Berlin"
_NO_ZONES = ("Factory", "localtime", "posixrules")
"""The files beside those of the zones: placeholders and settings."""
_COPIES = ("posix/", "right/")
"""The folders with all zones once more; those in the second one count leap seconds, which clocks don't."""


def read_zone(name: str) -> ZoneInfo | None:
    """Return the zone with a name such as `Europe/Berlin`; None for "", the computer's own, which is that of datetimes
    without one. Raises MissionError (BT194).
    """
    try:
        if name in _NO_ZONES or name.startswith(_COPIES):
            raise KeyError(name)
        return ZoneInfo(name) if name else None
    except (KeyError, ValueError, OSError):  # unknown, no name at all, a folder of zones
        raise MissionError([
            diagnostic(
                "BT194", Span(Source(name, "<time zone>"), 0, len(name)),
                what=f"'{name}'", problem="isn't a time zone", advice=_advice(name),
            )
        ]) from None  # fmt: skip


def moment_of(day: date, seconds: int, zone: ZoneInfo | None, *, earliest: bool = False) -> float:
    """Return the seconds since 1970 of a wall-clock time, given in seconds since midnight, which may be more than a day
    has.

    The first time where it comes twice, and as much later as a gap is long where it doesn't exist. With `earliest` the
    clock shows no time before a moment that is this one or, for a time in a gap, somewhat earlier.
    """
    wall = (datetime.combine(day, time()) + timedelta(seconds=seconds)).replace(tzinfo=zone)
    found = wall.timestamp()
    return min(found, wall.replace(fold=1).timestamp()) if earliest else found


def day_of(moment: float, zone: ZoneInfo | None) -> date:
    """Return the day of a moment in seconds since 1970."""
    return datetime.fromtimestamp(moment, zone).date()


def _advice(name: str) -> str:
    known = available_timezones().difference(_NO_ZONES)
    if not known:
        return "This computer has no time zones; install them: pip install tzdata"
    similar = nearest(name.lower(), known) if len(name) <= _LONGEST else []
    return f"Similar: {', '.join(similar)}" if similar else f"Write for example: {_EXAMPLE}"


_UNITS = (("hour", 3600), ("minute", 60), ("second", 1))


class Rule(Record):
    """A rule for times: on each of the `days` either at some `times`, in order, or again after each `interval` in a
    `window`: from its first time to its last one (on the next day if that isn't later), or without a window the whole
    day. Times are in seconds since midnight, the interval is in seconds. `str` gives canonical English, which is read
    as an equal rule.
    """

    days: Days
    times: tuple[int, ...] = ()
    interval: int = 0
    window: tuple[int, ...] = ()

    def __str__(self) -> str:
        if self.times:
            return f"{self.days} at {joined([shown(time) for time in self.times])}"
        days = str(self.days).removeprefix(str(Days())).strip()
        between = f"between {shown(self.window[0])} and {shown(self.window[1])}" if self.window else ""
        return " ".join(part for part in (_every(self.interval), between, days) if part)


def _every(seconds: int) -> str:
    unit, length = next((unit, length) for unit, length in _UNITS if seconds % length == 0)
    count = seconds // length
    return f"every {unit}" if count == 1 else f"every {count} {unit}s"


def format_moment(moment: float, now: float) -> str:
    """Write a time since 1970 in the time zone of this computer: "14:30" on the same day, else "2026-11-24 14:30"."""
    there, today = localtime(moment), localtime(now)
    clock = strftime("%H:%M:%S" if there.tm_sec else "%H:%M", there)
    return clock if there[:3] == today[:3] else f"{strftime('%Y-%m-%d', there)} {clock}"


def format_duration(seconds: float) -> str:
    """Return a duration in the longest unit of which it's a whole number: "10 min"."""
    unit, size = next((each for each in (("h", 3600), ("min", 60)) if seconds % each[1] == 0), ("s", 1))
    return f"{seconds / size:g} {unit}"

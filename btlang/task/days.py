"""Days of the calendar that a schedule is for, and the English names of weekdays, months and ordinal numbers."""

from __future__ import annotations

from calendar import monthrange
from collections.abc import Iterator
from datetime import date

from btlang.support.record import Record
from btlang.text.enumeration import NTH, joined, nth
from btlang.text.time_of_day import EVERY_DAY, WEEKDAYS, WEEKEND, WORKDAYS

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
"""Behind the figures of an ordinal number."""


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
        """Those from a day on, to the end of `YEARS`."""
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

"""When rules are due, found the slow way: by looking at each minute what a clock on the wall shows."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, date, datetime, time, timedelta
from functools import cache
from zoneinfo import ZoneInfo

from hypothesis import strategies as st

from btlang.task.schedule.calendar import LAST, Days, Rule
from btlang.text.time_of_day import EVERY_DAY

MINUTE, DAY = timedelta(minutes=1), timedelta(days=1)
CHANGES = (
    ("Europe/Berlin", date(2026, 3, 29)),
    ("Europe/Berlin", date(2026, 10, 25)),
    ("America/New_York", date(2026, 3, 8)),
    ("America/New_York", date(2026, 11, 1)),
    ("Australia/Lord_Howe", date(2026, 4, 5)),  # by half an hour
    ("Australia/Lord_Howe", date(2026, 10, 4)),
    ("America/Havana", date(2026, 3, 8)),  # at midnight
    ("America/Havana", date(2026, 11, 1)),
    ("Pacific/Apia", date(2011, 12, 30)),  # the clock skips this day
    ("UTC", date(2026, 2, 28)),
)
"""Zones, and days around which their clocks change."""


class WallClock:
    """A clock in a zone from five days before a day to five days after it."""

    def __init__(self, zone: str, day: date) -> None:
        middle = int(datetime.combine(day, time(), UTC).timestamp())
        self.minutes = range(middle - 5 * 86_400, middle + 5 * 86_400, 60)
        self._first: dict[datetime, int] = {}
        for minute in self.minutes:
            shown = datetime.fromtimestamp(minute, ZoneInfo(zone)).replace(tzinfo=None, fold=0)
            self._first.setdefault(shown, minute)

    def moment(self, wall: datetime) -> int:
        """When it shows a time first; for one that it skips, as much later as the gap is long."""
        if wall in self._first:
            return self._first[wall]
        before = after = wall
        while before not in self._first:
            before -= MINUTE
        while after not in self._first:
            after += MINUTE
        return self._first[wall + (after - before - MINUTE)]

    def due(self, rule: Rule, day: date) -> Iterator[int]:
        """The moments of a rule that belong to one day."""
        midnight = datetime.combine(day, time())
        for seconds in rule.times:
            yield self.moment(midnight + timedelta(seconds=seconds))
        if rule.interval:
            begin, end = (timedelta(seconds=seconds) for seconds in rule.window or (0, 86_400))
            first = self.moment(midnight + begin)
            last = self.moment(midnight + (end if end > begin else end + DAY))
            for minute in self.minutes:
                is_within = first <= minute <= last if rule.window else first <= minute < last
                if (is_within or (rule.window and minute == first)) and (minute - first) % rule.interval == 0:
                    yield minute


@cache
def clock(zone: str, day: date) -> WallClock:
    """The same one each time."""
    return WallClock(zone, day)


def is_on(days: Days, day: date) -> bool:
    """Whether they are for a day."""
    if days.single:
        return (day.month, day.day) == days.single[1:] and days.single[0] in (0, day.year)
    month = [day.replace(day=1) + number * DAY for number in range(31)]
    month = [other for other in month if other.month == day.month]
    if days.month_days:
        return any(day == month[-1] or number != LAST for number in days.month_days if number in (LAST, day.day))
    same = [other for other in month if other.weekday() == day.weekday()]
    counts = (same.index(day) + 1, LAST if day == same[-1] else 0)
    return day.weekday() in days.weekdays and (not days.which or any(count in days.which for count in counts))


def _ordered(numbers: set[int]) -> tuple[int, ...]:
    return tuple(sorted(numbers, key=lambda number: (number == LAST, number)))


def _chosen(numbers: range) -> st.SearchStrategy[tuple[int, ...]]:
    return st.sets(st.sampled_from(numbers), min_size=1, max_size=4).map(_ordered)


_MINUTES = st.one_of(st.integers(0, 4 * 60), st.integers(0, 24 * 60 - 1)).map(lambda minutes: minutes * 60)
_DAYS = st.one_of(
    st.just(Days()),
    st.sets(st.sampled_from(EVERY_DAY), min_size=1).map(lambda days: Days(tuple(sorted(days)))),
    st.builds(lambda day, which: Days((day,), which=which), st.sampled_from(EVERY_DAY), _chosen(range(1, 6))),
    st.builds(lambda day: Days((day,), which=(LAST,)), st.sampled_from(EVERY_DAY)),
    _chosen(range(1, 32)).map(lambda days: Days(month_days=days)),
    _chosen(range(25, 32)).map(lambda days: Days(month_days=(*days, LAST))),
    st.dates(date(2026, 1, 1), date(2027, 12, 31)).map(lambda day: Days(single=(day.year, day.month, day.day))),
    st.dates(date(2028, 1, 1), date(2028, 12, 31)).map(lambda day: Days(single=(0, day.month, day.day))),
    st.sampled_from(CHANGES).map(lambda change: Days(single=(change[1].year, change[1].month, change[1].day))),
)
_INTERVALS = st.one_of(st.integers(1, 24 * 60), st.sampled_from((1, 15, 30, 60, 90, 120))).map(lambda count: count * 60)
_WINDOWS = st.one_of(st.just(()), st.tuples(_MINUTES, _MINUTES).filter(lambda ends: ends[0] != ends[1]))
RULES = st.one_of(
    st.builds(Rule, _DAYS, st.sets(_MINUTES, min_size=1, max_size=4).map(_ordered)),
    st.builds(Rule, _DAYS, st.just(()), _INTERVALS, _WINDOWS),
)
"""Rules of any kind, many of them for the hours in which clocks change."""

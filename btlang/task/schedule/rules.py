"""Reads rules in English: parts for the days, the times, an interval and a window, in any order, each once."""

from __future__ import annotations

from btlang.task.schedule.calendar import LAST, Days, Rule
from btlang.task.schedule.words import ScheduleWords, Unread, read_length
from btlang.text.source import Source
from btlang.text.time_of_day import DAY, EVERY_DAY, shown

EXAMPLE = "every day at 9:00"
_SHORTEST = 60  # seconds between two times
_EXACT = 1e-6  # seconds
_NOON = 12 * 3600
_MOST_IN_MONTH = 5  # of one weekday
_WINDOW = "every 2 hours between 10:00 and 18:00"
_EVERY = ("every", "each")
_EVERY_MONTH = (
    "of every month", "of each month", "of month", "in every month", "in each month", "every month", "each month",
)  # fmt: skip
_EVERY_YEAR = ("of every year", "of each year", "every year", "each year")
_PERIODS = {
    "weekly": "week", "every week": "week", "each week": "week",
    "monthly": "month", "every month": "month", "each month": "month",
    "yearly": "year", "every year": "year", "each year": "year",
}  # fmt: skip
_DAY_OF = {"week": "on Monday", "month": "on the 1st", "year": "on 24 December"}
_SHORT_UNITS = ("hour", "hours", "minute", "minutes")
_LONG_UNITS = ("day", "days", "week", "weeks", "weekend", "weekends", "month", "months", "year", "years")


def read_rule_in(words: ScheduleWords) -> Rule:
    """Read the rule that all of the words are. Raises Unread."""
    try:
        return _RuleReader(words).rule()
    except Unread:
        seconds = read_length(words.source)
        if seconds is None:
            raise
    raise words.whole("is a length of time, not a schedule", _example_with(words.source, seconds))


def _example_with(length: Source, seconds: float) -> str:
    """Return the rule that is meant by a length of time."""
    written = f"every {length.text.strip()}"
    try:
        _RuleReader(ScheduleWords(Source(written))).rule()
    except Unread as unread:  # `every 1 h 30 min`, `every 2 weeks`
        if seconds < DAY and seconds % _SHORTEST == 0:
            return f"every {seconds / _SHORTEST:g} minutes"
        return EXAMPLE if seconds <= DAY else unread.example or EXAMPLE
    return written


class _RuleReader:
    """A reader of one rule, which gathers its parts."""

    def __init__(self, words: ScheduleWords) -> None:
        self._words = words
        self._days: Days | None = None
        self._times: tuple[int, ...] = ()
        self._interval = 0
        self._window: tuple[int, ...] = ()
        self._excepted: tuple[int, ...] = ()
        self._on_the_hour = False
        self._periods: set[str] = set()
        """`week` where the rule says `weekly` or `every week`, and so on."""
        self._unsure: tuple[str, Unread] | None = None
        """What is wrong with the days unless the rule says a period: `on Monday` may be any, or only the next one."""

    def rule(self) -> Rule:
        """Return the rule. Raises Unread."""
        words = self._words
        while not words.is_over:
            if not words.takes(","):
                self._read_part()
        if not words.at:
            raise words.incomplete("")
        if self._times and self._interval:
            raise words.wrong("says both how often and at what time", 0)
        days = self._all_days()
        if not self._interval and not self._times:
            lacked = ("how often", "every 2 hours") if self._window else ("at what time", "at 9:00")
            raise words.incomplete(f"doesn't say {lacked[0]}", lacked[1])
        if self._window and not self._interval:
            raise words.wrong("has both a time and a window", 0, _WINDOW)
        begin = self._window[0] if self._window else 0
        if self._on_the_hour and (not self._interval or self._interval % 3600 or begin % 3600):
            raise words.wrong("isn't always on the hour", 0, "every hour on the hour between 10:00 and 18:00")
        return Rule(days, self._times, self._interval, self._window)

    def _all_days(self) -> Days:
        words, days = self._words, self._days
        if self._unsure is not None and self._unsure[0] not in self._periods:
            raise self._unsure[1]
        for period in sorted(self._periods):
            if days is None or _period(days) != period:
                raise words.incomplete(f"doesn't say on which day of the {period}", _DAY_OF[period])
        if days is None and self._times:
            raise words.incomplete("doesn't say on which days", "every day")
        days = days or Days()
        left = tuple(day for day in days.weekdays if day not in self._excepted)
        if self._excepted and days != Days(days.weekdays):
            raise words.wrong("can't leave out weekdays: only 'every day' and lists of weekdays can", 0)
        if not left:
            raise words.wrong("leaves no day", 0)
        return Days(left) if self._excepted else days

    def _read_part(self) -> None:
        words, first = self._words, self._words.at
        if words.takes("at"):
            self._read_times(first, words.need_time())
        elif (time := words.time_of_day()) is not None:
            self._read_times(first, time)
        elif words.takes("on hour"):
            self._on_the_hour = True
        elif words.takes("between"):
            self._read_window(first, "and")
        elif words.takes("from"):
            if not self._read_weekdays(first, every=False):
                self._read_window(first, "to", "until", "till")
        elif words.exception():
            self._once(first, bool(self._excepted), "exceptions are")
            self._excepted = self._weekdays()[0]
            if not self._excepted:
                raise words.unknown("every day except Sunday at 10:00")
        elif words.takes("hourly"):
            self._set_interval(first, 3600)
        elif period := words.takes(*_PERIODS):
            self._periods.add(_PERIODS[period])
        elif words.takes("and"):
            if words.is_over:
                raise words.incomplete("isn't complete")
            raise words.wrong("can't join two rules: make a schedule of each", first, "every day at 9:00 and 14:30")
        else:
            self._read_days(first)

    def _once(self, first: int, is_known: bool, what: str) -> None:
        if is_known:
            raise self._words.wrong(f"doesn't fit here: the {what} already given", first)

    def _read_times(self, first: int, time: int) -> None:
        """Read the times behind the first one."""
        self._once(first, bool(self._times), "times are")
        more = self._words.read_list(self._words.read_listed_time, "at", goes_on=True)
        self._times = tuple(sorted({time, *more}))

    def _read_window(self, first: int, *joining: str) -> None:
        words = self._words
        self._once(first, bool(self._window), "window is")
        places, times, bare = [], [], []
        for joiners in ((), joining):
            if joiners and not words.takes(*joiners):
                raise words.unknown(_WINDOW)
            places.append(words.at)
            hour = words.hour()
            times.append(words.need_time() if hour is None else hour[0])
            bare.append(hour is not None and hour[1])
        if any(bare) and words.says_half(first):  # `between 2 and 4 pm`: that may be 2:00 or 14:00
            words.at = places[bare.index(True)]
            words.need_time()
        begin, end = times
        if all(bare) and 0 < end < begin <= _NOON:
            ways = [f"between {shown(begin)} and {shown(either)}" for either in (end + _NOON, end)]
            raise words.wrong("can be read in two ways", first, ", or ".join(ways))
        if begin == end:
            raise words.wrong("begins and ends at the same time", first, _WINDOW)
        self._window = begin, end

    def _set_interval(self, first: int, seconds: float) -> None:
        words, whole = self._words, round(seconds)
        self._once(first, bool(self._interval), "interval is")
        if seconds < _SHORTEST:
            raise words.wrong("is less than a minute", first, "every minute")
        if seconds > DAY:
            raise words.wrong("is more than a day", first, EXAMPLE)
        if abs(whole - seconds) > _EXACT:
            raise words.wrong("isn't a whole number of seconds", first, f"every {whole} seconds")
        self._interval = whole

    def _read_days(self, first: int) -> None:
        """Read days, or `every` with a duration, which begins as days do."""
        words = self._words
        words.takes("on")
        every = bool(words.takes(*_EVERY))
        if every:
            self._refuse_counted(first)
        if words.takes("daily", "everyday") or (every and words.takes("day", *words.parts_of_day)):
            self._set_days(first, Days())
        elif (single := words.calendar_date()) is not None:
            if not (single[0] or every or words.takes(*_EVERY_YEAR)):
                written = words.since(first).text
                example = f"{written} 2026, or {written} of every year"
                self._unsure = "year", words.wrong("doesn't say in which year", first, example)
            self._set_days(first, Days(single=single))
        elif not self._read_ordinals(first, every=every) and not self._read_weekdays(first, every=every):
            seconds = words.duration() if every else None
            if seconds is None:
                raise words.unknown("on 2026-12-24 at 9:00" if words.ahead()[0].isdecimal() else EXAMPLE)
            self._set_interval(first, seconds)

    def _set_days(self, first: int, days: Days) -> None:
        self._once(first, self._days is not None, "days are")
        self._days = days

    def _refuse_counted(self, first: int) -> None:
        """Refuse `every 2 weeks` and `every other Tuesday`: nobody knows which one is the first."""
        words, begin = self._words, self._words.at
        other = words.takes("other")
        units = (*_LONG_UNITS, *_SHORT_UNITS) if other else _LONG_UNITS
        if (other or words.number() is not None) and (words.takes(*units) or words.weekdays()):
            raise self._refuse_count(first)
        words.at = begin

    def _refuse_count(self, first: int) -> Unread:
        short = self._words.since(first).text.split()[-1].lower() in _SHORT_UNITS
        example = "every 2 hours" if short else "every Tuesday, or on the second Tuesday of every month"
        return self._words.wrong("doesn't say where to start counting", first, example)

    def _read_ordinals(self, first: int, *, every: bool) -> bool:
        """Read `1st and 15th of every month`, `second Tuesday of every month`."""
        words, begin = self._words, self._words.at
        numbers = words.read_list(words.ordinal)
        if not numbers:
            return False
        weekday = words.weekdays()
        is_day = weekday is None and words.takes("day", "days")
        monthly = words.takes(*_EVERY_MONTH) or "month" in self._periods
        if every and not monthly:
            if weekday or is_day or words.takes(*_LONG_UNITS, *_SHORT_UNITS):
                raise self._refuse_count(first)
            words.at = begin  # `every second` alone
            return False
        most = _MOST_IN_MONTH if weekday else 31
        if any(number != LAST and not 1 <= number <= most for number in numbers) or (weekday and len(weekday[0]) > 1):
            example = f"on the {'first Monday' if weekday else 'last day'} of every month"
            raise words.wrong("isn't a day of a month", first, example)
        if not monthly:
            example = f"{words.since(first).text} of every month"
            self._unsure = "month", words.wrong("doesn't say of which month", first, example)
        ordered = tuple(sorted(set(numbers), key=lambda number: (number == LAST, number)))
        self._set_days(first, Days(weekday[0], which=ordered) if weekday else Days(month_days=ordered))
        return True

    def _read_weekdays(self, first: int, *, every: bool) -> bool:
        days, weekly = self._weekdays()
        if not days:
            return False
        if not every and not weekly:
            example = str(Days(days))
            self._unsure = "week", self._words.wrong("doesn't say whether it's every week", first, example)
        self._set_days(first, Days(days))
        return True

    def _weekdays(self) -> tuple[tuple[int, ...], bool]:
        """Read a list of weekdays, and whether it says that every week is meant."""
        found = self._words.read_list(self._words.weekdays, "on every", "on each", "on", *_EVERY)
        days = {day for those, _ in found for day in those}
        return tuple(sorted(days)), any(weekly for _, weekly in found)


def _period(days: Days) -> str:
    """Return what the days come again in."""
    if days.single:
        return "" if days.single[0] else "year"
    if days.month_days or days.which:
        return "month"
    return "" if days.weekdays == EVERY_DAY else "week"

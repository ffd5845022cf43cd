"""Rules such as `every day at 9:00`: when something is to happen, by the clock on the wall."""

from __future__ import annotations

from btlang.support.record import Record
from btlang.task.days import Days
from btlang.text.enumeration import joined
from btlang.text.time_of_day import shown

_UNITS = (("hour", 3600), ("minute", 60), ("second", 1))


class Rule(Record):
    """On each of the `days` either at some `times`, in order, or again after each `interval` in a `window`: from its
    first time to its last one (on the next day if that isn't later), or without a window the whole day. Times are in
    seconds since midnight, the interval is in seconds. `str` gives canonical English, which is read as an equal rule.
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

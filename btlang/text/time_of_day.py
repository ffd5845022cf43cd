"""Times of day: texts such as "18:30" to seconds since midnight, and back."""

from __future__ import annotations

import re
import time

DAY = 86_400.0
"""Seconds."""
WEEKDAYS = ("Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday")
"""In English, in the order of their numbers."""
EVERY_DAY, WORKDAYS, WEEKEND = tuple(range(7)), tuple(range(5)), (5, 6)
"""The numbers of days."""
USUAL_START = 9 * 3600.0
"""The time of day at which a world begins that does not say when."""
_TIME = re.compile(r"([01]?\d|2[0-3]):([0-5]\d)", re.ASCII)


def seconds_of(text: str) -> float:
    """Return the seconds since midnight of "18:30". Raises ValueError for anything else."""
    found = _TIME.fullmatch(text)
    if found is None:
        raise ValueError(f"must be a time of day such as 18:30, not {text!r}")
    return int(found[1]) * 3600.0 + int(found[2]) * 60.0


def weekday_after(first: int, seconds: float) -> int:
    """Return the number of the weekday so many seconds after the midnight at which another one began."""
    return (first + int(seconds // DAY)) % len(WEEKDAYS)


def shown(seconds: float) -> str:
    """Format hours and minutes, and seconds if there are some: "18:30", "18:30:05"."""
    whole = int(round(seconds, 3) % DAY)
    text = f"{whole // 3600:02}:{whole // 60 % 60:02}"
    return f"{text}:{whole % 60:02}" if whole % 60 else text


def local(moment: float) -> float:
    """Return the seconds since midnight, in the time zone of this computer, of a moment in seconds since 1970."""
    there = time.localtime(moment)
    return there.tm_hour * 3600.0 + there.tm_min * 60.0 + there.tm_sec + moment % 1.0

"""Moments and durations as people read them."""

from __future__ import annotations

import time


def shown(moment: float, now: float) -> str:
    """A time since 1970 in the time zone of this computer: "14:30" on the same day, else "2026-11-24 14:30"."""
    there, today = time.localtime(moment), time.localtime(now)
    clock = time.strftime("%H:%M:%S" if there.tm_sec else "%H:%M", there)
    return clock if there[:3] == today[:3] else f"{time.strftime('%Y-%m-%d', there)} {clock}"


def length(seconds: float) -> str:
    """A duration in the longest unit of which it's a whole number: "10 min"."""
    unit, size = next((each for each in (("h", 3600), ("min", 60)) if seconds % each[1] == 0), ("s", 1))
    return f"{seconds / size:g} {unit}"

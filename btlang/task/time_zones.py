"""Time zones by their names, and the moments of wall-clock times in them."""

from __future__ import annotations

from datetime import date, datetime, time, timedelta
from zoneinfo import ZoneInfo, available_timezones

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest

_LONGEST = 80  # characters of a name that may be a misspelling
_EXAMPLE = "Europe/Berlin"
_NO_ZONES = ("Factory", "localtime", "posixrules")
"""Files beside those of the zones: placeholders and settings."""
_COPIES = ("posix/", "right/")
"""Folders with all zones once more; those in the second one count leap seconds, which clocks don't."""


def read_zone(name: str) -> ZoneInfo | None:
    """The zone with a name such as `Europe/Berlin`; None for "", the computer's own, which is that of datetimes without
    one. Raises MissionError (BT194).
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
    """Seconds since 1970 of a wall-clock time, given in seconds since midnight, which may be more than a day has.

    The first time where it comes twice, and as much later as a gap is long where it doesn't exist. With `earliest`
    the clock shows no time before a moment that is this one or, for a time in a gap, somewhat earlier.
    """
    wall = (datetime.combine(day, time()) + timedelta(seconds=seconds)).replace(tzinfo=zone)
    found = wall.timestamp()
    return min(found, wall.replace(fold=1).timestamp()) if earliest else found


def day_of(moment: float, zone: ZoneInfo | None) -> date:
    """The day of a moment in seconds since 1970."""
    return datetime.fromtimestamp(moment, zone).date()


def _advice(name: str) -> str:
    known = available_timezones().difference(_NO_ZONES)
    if not known:
        return "This computer has no time zones; install them: pip install tzdata"
    similar = nearest(name.lower(), known) if len(name) <= _LONGEST else []
    return f"Similar: {', '.join(similar)}" if similar else f"Write for example: {_EXAMPLE}"

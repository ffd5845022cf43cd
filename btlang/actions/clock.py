"""Conditions and quantities of the time of day."""

from __future__ import annotations

from btlang.engine.leaves.leaf import Failed
from btlang.text.time_of_day import WEEKDAYS, WEEKEND, seconds_of, shown

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.clock import Clock


def time_of_day(
    clock: Clock,
    above: str | None = None,
    below: str | None = None,
    at_least: str | None = None,
    at_most: str | None = None,
) -> bool | Failed:
    """Return whether it is after or before a time of this day, or between two, possibly across midnight."""
    now = clock.time_of_day
    begun = at_least is None or now >= seconds_of(at_least)
    lasts = at_most is None or now <= seconds_of(at_most)
    past_midnight = at_least is not None and at_most is not None and seconds_of(at_least) > seconds_of(at_most)
    is_between = begun or lasts if past_midnight else begun and lasts
    holds = is_between and (above is None or now > seconds_of(above)) and (below is None or now < seconds_of(below))
    return holds or Failed(lambda: f"it is {shown(now)}")


def today_is(clock: Clock, days: str) -> bool | Failed:
    """Return whether it is one of some weekdays: names of days, `weekdays` or `weekends`, between semicolons."""
    today = WEEKDAYS[clock.weekday]
    kind = "weekends" if clock.weekday in WEEKEND else "weekdays"
    wanted = {day.strip().lower() for day in days.split(";")}
    return not wanted.isdisjoint((today.lower(), kind)) or Failed(lambda: f"it is {today}")


def day_of_week(clock: Clock) -> str:
    """Return the name of the day, as Monday."""
    return WEEKDAYS[clock.weekday]


def time_now(clock: Clock) -> str:
    """Return the time of day, as 18:05."""
    return shown(clock.time_of_day)

"""The one source of time of a running mission: somebody drives it, nothing in a tree sleeps."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from btlang.text.time_of_day import DAY, USUAL_START, weekday_after

SOONEST = 0.001
"""Seconds after which a leaf may be ticked again at the earliest, so that none can hold the time of a mission."""


class Clock:
    """Seconds since the mission began, moved on by the runner (or a test). Never goes back.

    What waits says during a tick when it is due (`wake_at`); it says so again at the next tick if it still waits then.
    `due` is the earliest of these times, inf where nothing waits. The runner sets it back before each tick. `day` gives
    the seconds since midnight where the mission runs, `week` the number of the weekday (0 is Monday), None where nobody
    knows.
    """

    __slots__ = ("day", "due", "now", "week")

    def __init__(self, now: float = 0.0) -> None:
        self.now = now
        self.due = inf
        self.day: Callable[[], float] | None = None
        self.week: Callable[[], int] | None = None

    @property
    def time_of_day(self) -> float:
        """Seconds since midnight; where nobody knows, the mission began at 9 o'clock."""
        return (USUAL_START + self.now) % DAY if self.day is None else self.day()

    @property
    def weekday(self) -> int:
        """The number of the weekday, 0 for Monday; where nobody knows, the mission began on one."""
        return weekday_after(0, USUAL_START + self.now) if self.week is None else self.week()

    def advance(self, seconds: float) -> None:
        """Raises ValueError for a negative step."""
        if seconds < 0:
            raise ValueError(f"time does not go back: {seconds}")
        self.now += seconds

    def wake_at(self, time: float) -> None:
        """Asks for a tick at that time, at once if it is now. A time in the past asks for nothing."""
        if self.now <= time < self.due:
            self.due = time

    def leaf_wake_at(self, time: float) -> None:
        """As `wake_at`, for leaves, which are not ticked again sooner than SOONEST from now."""
        self.wake_at(max(time, self.now + SOONEST))

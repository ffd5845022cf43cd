"""The time of a mission, which only its driver moves on, and how long leaves really take."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import perf_counter

from btlang.text.time_of_day import DAY, USUAL_START, weekday_after

SOONEST = 0.001
"""Seconds after which a leaf may be ticked again at the earliest, so that none can hold the time of a mission."""


class Clock:
    """The seconds since the mission began, moved on by the runner or a test. They never go back.

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
        """The seconds since midnight. If nobody knows them, the mission began at 9 o'clock."""
        return (USUAL_START + self.now) % DAY if self.day is None else self.day()

    @property
    def weekday(self) -> int:
        """The number of the weekday, 0 for Monday. If nobody knows it, the mission began on a Monday."""
        return weekday_after(0, USUAL_START + self.now) if self.week is None else self.week()

    def advance(self, seconds: float) -> None:
        """Move the time on. Raises ValueError for a negative step."""
        if seconds < 0:
            raise ValueError(f"time does not go back: {seconds}")
        self.now += seconds

    def wake_at(self, time: float) -> None:
        """Ask for a tick at that time, at once if it is now. A time in the past asks for nothing."""
        if self.now <= time < self.due:
            self.due = time

    def leaf_wake_at(self, time: float) -> None:
        """Ask for a tick as `wake_at` does, for a leaf, which isn't ticked again sooner than SOONEST from now."""
        self.wake_at(max(time, self.now + SOONEST))


class LeafTimer:
    """The real seconds that each leaf spends in its ticks and halts, by index in preorder."""

    def __init__(self) -> None:
        self.spent: dict[int, float] = {}

    def wrap(
        self, index: int, compiled: tuple[Callable[[], int], Callable[[bool], None]]
    ) -> tuple[Callable[[], int], Callable[[bool], None]]:
        """Return the same leaf, timed."""
        tick, halt = compiled
        spent = self.spent

        def timed_tick() -> int:
            began = perf_counter()
            try:
                return tick()
            finally:
                spent[index] = spent.get(index, 0.0) + perf_counter() - began

        def timed_halt(keep: bool) -> None:
            began = perf_counter()
            try:
                halt(keep)
            finally:
                spent[index] = spent.get(index, 0.0) + perf_counter() - began

        return timed_tick, timed_halt

    def slowest(self) -> tuple[int, float] | None:
        """Return index and seconds of the leaf that took longest since `spent` was cleared, None if no leaf ran."""
        return max(self.spent.items(), key=lambda item: item[1], default=None)

"""Plays a recording: hands its events to sinks at the pace of the mission, with pause, single steps and a start."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence

from btlang.engine.status import FAILURE
from btlang.run.controls import Controls
from btlang.run.events import Event, PeriodPassed, StatusesChanged


def play(
    events: Iterable[Event],
    sinks: Sequence[Callable[[Event], object]],
    controls: Controls,
    speed: float,
    start: float = -math.inf,
) -> bool:
    """Plays events to their end; returns False if it was stopped before.

    `speed` is seconds of the mission per second of real time, math.inf for no pauses. What comes before `start`, in
    seconds of the mission, comes at once. A step goes on to the end of the next period.
    """
    began: float | None = None  # the real time at which the mission would have begun, None where it stands still
    for event in events:
        if event.t >= start and speed < math.inf:
            began = time.monotonic() - event.t / speed if began is None else began
            due = began + event.t / speed
            while not (controls.stopped or controls.paused) and (left := due - time.monotonic()) > 0:
                controls.wait(left)
        for sink in sinks:
            sink(event)
        if event.t >= start and isinstance(event, PeriodPassed) and controls.paused:
            began = None
            while controls.paused and not controls.stopped and not controls.take_step():
                controls.wait(None)
        if controls.stopped:
            return False
    return True


def failures(events: Iterable[Event]) -> list[float]:
    """When nodes failed, in seconds of the mission."""
    found: dict[float, None] = {}
    for event in events:
        if isinstance(event, StatusesChanged) and any(status == FAILURE for _, status, _, _ in event.without_paths()):
            found[event.t] = None
    return list(found)

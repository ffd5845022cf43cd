"""Reads what no event reports during a run: values of the blackboard, and scans at a chosen rate."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.engine.blackboard import Blackboard
from btlang.run.bus import INLINE, Bus
from btlang.run.events import Event, PeriodPassed, Sampled
from btlang.run.robot_state import ask_sensor

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def numbers_in(values: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, float]]:
    """Yield the values of the blackboard that the mission names and that are numbers."""
    for name, value in values:
        if not name.startswith("_") and isinstance(value, int | float) and not isinstance(value, bool):
            yield name, value


class Sampler:
    """A sink in the thread of the run. It publishes what it finds on the run's bus, at the end of each period.

    `values` is the outermost scope of the blackboard. `scans` is how many there are in a second of mission time.
    """

    policy = INLINE

    def __init__(self, bus: Bus, values: Blackboard, scans: float) -> None:
        self._bus, self._blackboard, self._scans = bus, values, scans
        self._known: dict[str, Any] = {}
        self._next_scan = 0.0

    def __call__(self, event: Event) -> None:
        """Take in an event of the run."""
        if not isinstance(event, PeriodPassed):
            return
        changed = {}
        for key in self._blackboard.keys():  # noqa: SIM118 - it is no dict
            value = self._blackboard.get(key)
            if key not in self._known or self._known[key] != value:
                self._known[key] = changed[key] = value
        scan = self._scan(event) if self._scans and event.t >= self._next_scan - 1e-9 else ()
        if changed or scan:
            self._bus.emit(Sampled, changed, scan)

    def _scan(self, event: PeriodPassed) -> tuple[float, ...]:
        self._next_scan = event.t + 1 / self._scans
        return tuple(ask_sensor(lambda: [float(distance) for distance in event.robot.scan()]) or ())

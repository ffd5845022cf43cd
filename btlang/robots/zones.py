"""Zones: where the robot may not go, or only slowly. A mission may close and open them until it ends."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point
from btlang.robots.world import Zone, said


class Zones:
    """The zones of a world as they are now. `version` changes whenever one is closed or opened."""

    def __init__(self, zones: Iterable[Zone]) -> None:
        self._zones = {zone.name.lower(): zone for zone in zones}
        self._said: dict[str, bool] = {}
        self.version = 0
        self.closed: Sequence[Zone] = ()
        """Those to keep out of."""
        self.slow: Sequence[Zone] = ()
        """Those to drive slowly through."""
        self.begin()

    def begin(self) -> None:
        """A run begins: zones are as the world says."""
        self._said.clear()
        self._sort()

    def close(self, name: str) -> None:
        """The robot keeps out of it from now on. Raises ActionFailed for an unknown one."""
        self._say(name, True)

    def open(self, name: str) -> None:
        """The robot may go there again. Raises ActionFailed for an unknown one."""
        self._say(name, False)

    def is_closed(self, name: str) -> bool:
        """Whether the robot keeps out of it. Raises ActionFailed for an unknown one."""
        return self._zone(name) in self.closed

    def refusal(self, name: str, point: Point) -> str | None:
        """Why the robot may not go to a point that is called so; None where it may."""
        zone = next((zone for zone in self.closed if zone.contains(point)), None)
        return None if zone is None else f"{said(name)} is in the {zone.name}, where the robot may not go"

    def contains(self, name: str, point: Point) -> bool:
        """Whether a point lies in a zone. Raises ActionFailed for an unknown one."""
        return self._zone(name).contains(point)

    def _say(self, name: str, closed: bool) -> None:
        self._said[self._zone(name).name] = closed
        self._sort()

    def _sort(self) -> None:
        self.version += 1
        zones = self._zones.values()
        self.closed = [zone for zone in zones if self._said.get(zone.name, zone.is_closed)]
        self.slow = [zone for zone in zones if zone not in self.closed and not zone.is_closed]

    def _zone(self, name: str) -> Zone:
        if (zone := self._zones.get(name.lower())) is None:
            raise ActionFailed(f"there's no zone called '{name}'")
        return zone

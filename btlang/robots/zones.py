"""Zones: where the robot may not go, or only slowly, or must stay. A mission may close and open them until it ends."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from math import dist

from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point, centre_of, edges, segment_distance
from btlang.robots.worlds.world import Zone, said

CLEAR = 0.8
"""Metres from the border of a zone to which the robot drives when it enters or leaves it."""
_OVER, _APART = 0.4, 0.5  # metres from the border at which it has done so; between two points along it


class Restriction:
    """Zones that the robot keeps out of, or stays in, from `begin` to `end`; others may be active, too.

    A context manager: with `zones.keep_out("stairs"): ...`.
    """

    def __init__(self, zones: Zones, names: Sequence[str], keeps_in: bool) -> None:
        self._zones, self.names, self.keeps_in = zones, names, keeps_in

    def begin(self) -> None:
        """Begin the restriction. Raises ActionFailed for an unknown zone."""
        self._zones.restrict(self, True)

    def end(self) -> None:
        """End the restriction. May be called twice."""
        self._zones.restrict(self, False)

    def __enter__(self) -> Restriction:
        self.begin()
        return self

    def __exit__(self, *problem: object) -> None:
        self.end()


class Zones:
    """The zones of a world as they are now. `version` changes whenever one is closed or opened."""

    def __init__(self, zones: Iterable[Zone]) -> None:
        self._zones = {zone.name.lower(): zone for zone in zones}
        self._said: dict[str, bool] = {}
        self._restrictions: list[Restriction] = []
        self.version = 0
        self.closed: Sequence[Zone] = ()
        """The zones to keep out of."""
        self.slow: Sequence[Zone] = ()
        """The zones to drive through slowly."""
        self.confines: Sequence[Sequence[Zone]] = ()
        """The zones to stay in: in at least one of each of these groups."""
        self.begin()

    def begin(self) -> None:
        """Begin a run: zones are as in the world."""
        self._said.clear()
        self._restrictions.clear()
        self._sort()

    def close(self, name: str) -> None:
        """Keep the robot out of a zone from now on. Raises ActionFailed for an unknown one."""
        self._say(name, True)

    def open(self, name: str) -> None:
        """Let the robot into a zone again. Raises ActionFailed for an unknown one."""
        self._say(name, False)

    def keep_out(self, *names: str) -> Restriction:
        """Return a restriction that closes zones while it is active, whatever else happens to them."""
        return Restriction(self, names, False)

    def keep_in(self, *names: str) -> Restriction:
        """Return a restriction that keeps the robot in these zones: in any of them."""
        return Restriction(self, names, True)

    def restrict(self, restriction: Restriction, holds: bool) -> None:
        """Begin or end a restriction."""
        for name in restriction.names:
            self._zone(name)
        self._restrictions = [each for each in self._restrictions if each is not restriction]
        if holds:
            self._restrictions.append(restriction)
        self._sort()

    def is_closed(self, name: str) -> bool:
        """Return whether the robot keeps out of a zone. Raises ActionFailed for an unknown one."""
        return self._zone(name) in self.closed

    def refusal(self, name: str, point: Point) -> str | None:
        """Return why the robot may not go to a named point; None if it may."""
        zone = next((zone for zone in self.closed if zone.contains(point)), None)
        if zone is not None:
            return f"{said(name)} is in the {zone.name}, where the robot may not go"
        left = next((zones for zones in self.confines if not any(zone.contains(point) for zone in zones)), None)
        return None if left is None else f"{said(name)} is outside {zone_names(left)}, where the robot has to stay"

    def contains(self, name: str, point: Point) -> bool:
        """Return whether a point lies in a zone. Raises ActionFailed for an unknown one."""
        return self._zone(name).contains(point)

    def spots(self, name: str, point: Point, inside: bool) -> list[Point]:
        """Return points a little inside or outside the border of a zone, the nearest to a point first."""
        zone = self._zone(name)
        found: list[Point] = []
        for (ax, ay), (bx, by) in edges(zone.points):
            length = dist((ax, ay), (bx, by)) or 1.0
            for number in range(int(length / _APART) + 1):
                share = min(1.0, (number + 0.5) * _APART / length) if length > _APART else 0.5
                x, y = ax + share * (bx - ax), ay + share * (by - ay)
                away = CLEAR * (by - ay) / length, CLEAR * (bx - ax) / length
                found += [(x - away[0], y + away[1]), (x + away[0], y - away[1])]
        if inside:
            found.append(centre_of(zone.points))
        return sorted((spot for spot in found if zone.contains(spot) == inside), key=partial(dist, point))

    def has(self, name: str) -> bool:
        """Return whether there is a zone of this name."""
        return name.lower() in self._zones

    def corners(self, name: str) -> Sequence[Point]:
        """Return the corners of a zone. Raises ActionFailed for an unknown one."""
        return self._zone(name).points

    def is_over(self, name: str, point: Point, inside: bool) -> bool:
        """Return whether a point is in a zone, or outside, and not right at its border."""
        zone = self._zone(name)
        border = min(segment_distance(point, (*start, *end)) for start, end in edges(zone.points))
        return zone.contains(point) == inside and border >= _OVER

    def _say(self, name: str, closed: bool) -> None:
        self._said[self._zone(name).name] = closed
        self._sort()

    def _sort(self) -> None:
        self.version += 1
        zones = self._zones.values()
        out = {name.lower() for each in self._restrictions if not each.keeps_in for name in each.names}
        self.closed = [zone for zone in zones if zone.name.lower() in out or self._said.get(zone.name, zone.is_closed)]
        self.confines = [[self._zone(name) for name in each.names] for each in self._restrictions if each.keeps_in]
        self.slow = [zone for zone in zones if zone not in self.closed and zone.is_slow]

    def _zone(self, name: str) -> Zone:
        if (zone := self._zones.get(name.lower())) is None:
            raise ActionFailed(f"there's no zone called '{name}'")
        return zone


def zone_names(zones: Sequence[Zone]) -> str:
    """Return the names of zones as they are spoken of: "the hall and the lab"."""
    return " and ".join(f"the {zone.name}" for zone in zones)

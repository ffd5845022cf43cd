"""How fast it is safe to drive near zones and near people who walk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import cos, hypot, inf, radians, sin, sqrt
from typing import Protocol

from btlang.robots.geometry import Point, Pose, Segment, edges, segment_distance
from btlang.robots.worlds.world import Zone
from btlang.robots.zones import Zones

_MARGIN = 0.08  # metres that stay free
_APPROACH = 0.6  # metres a second at which people may come nearer while it brakes; they look where they go
_DELAY = 0.05  # seconds until it brakes
_AHEAD = cos(radians(75.0))
_LOOK = 2.0  # metres
_EDGE = 0.02  # metres that stay free before a border
_PROBE = 0.05  # metres ahead
_RIM = tuple((cos(radians(side)), sin(radians(side))) for side in range(-90, 91, 30))  # the front half of the rim


class WalkingPeople(Protocol):
    """The people who walk, as far as the robot knows."""

    @property
    def walking(self) -> Mapping[str, tuple[float, float, float]]:
        """The x, y and radius of people by their names, on the map."""

    def wall_between(self, a: Point, b: Point) -> bool:
        """Return whether a wall crosses the straight line from a to b."""


def safe_among(people: WalkingPeople, pose: Pose, backward: bool, radius: float, brake: float) -> tuple[float, str]:
    """Return the metres a second that are safe near people, and who limits them; inf and "" if nobody does.

    They are for a robot with this radius and braking.
    """
    heading = radians(pose.heading + 180.0 * backward)
    ahead = cos(heading), cos(heading - radians(90.0))
    most, who = inf, ""
    lost = _APPROACH + _DELAY * brake
    for name, (x, y, wide) in people.walking.items():
        dx, dy = x - pose.x, y - pose.y
        if abs(dx) > _LOOK or abs(dy) > _LOOK:
            continue
        distance = hypot(dx, dy)
        if dx * ahead[0] + dy * ahead[1] < _AHEAD * distance:
            continue
        gap = distance - wide - radius - _MARGIN
        safe = sqrt(lost * lost + 2 * brake * gap) - lost if gap > 0.0 else 0.0
        if safe < most and not people.wall_between((pose.x, pose.y), (x, y)):
            most, who = safe, name
    return most, who


class Regions:
    """The zones as they are now, for a robot with this radius and braking."""

    def __init__(self, zones: Zones, radius: float, brake: float) -> None:
        self._zones, self._radius, self._brake = zones, radius, brake
        self._slow: list[tuple[Zone, Segment]] = []
        self._closed: list[tuple[Zone, Segment]] = []
        self._version = -1

    def safe(self, pose: Pose, backward: bool) -> tuple[float, str]:
        """Return the metres a second that are safe straight ahead or backward, and which zone stops the robot; inf
        without one.
        """
        if self._version != self._zones.version:
            self._measure()
        most = min(
            (zone.speed for zone, box in self._slow if _within(box, pose) and self._near(zone, pose)), default=inf
        )
        found = ""
        heading = radians(pose.heading + 180.0 * backward)
        direction = cos(heading), sin(heading)
        for zone, box in self._closed:
            if _within(box, pose) and (free := self._before(zone, pose, direction)) < most:
                most, found = free, zone.name
        for confines in self._zones.confines:
            if (free := self._inside(confines, pose, direction)) < most:
                most, found = free, confines[0].name
        return most, found

    def _measure(self) -> None:
        """Note in which boxes the zones matter: most of the time the robot is in none."""
        self._version = self._zones.version
        self._slow = [(zone, _box(zone, self._radius)) for zone in self._zones.slow]
        self._closed = [(zone, _box(zone, self._radius + _EDGE + _LOOK)) for zone in self._zones.closed]

    def _near(self, zone: Zone, pose: Pose) -> bool:
        point = pose.x, pose.y
        return zone.contains(point) or edge_distance(zone, point) < self._radius

    def _before(self, zone: Zone, pose: Pose, direction: Point) -> float:
        """Return the speed at which it can brake before the zone; inf if it drives away from it, or out of it."""
        point = pose.x, pose.y
        gap = edge_distance(zone, point) - self._radius - _EDGE
        if gap > _LOOK or zone.contains(point):
            return inf
        ahead = pose.x + _PROBE * direction[0], pose.y + _PROBE * direction[1]
        nearer = edge_distance(zone, point) - edge_distance(zone, ahead)
        if nearer <= 0.0 and not zone.contains(ahead):
            return inf
        return sqrt(2 * self._brake * max(0.0, gap) * _PROBE / max(nearer, 1e-9)) if gap > 0.0 else 0.0

    def _inside(self, zones: Sequence[Zone], pose: Pose, direction: Point) -> float:
        """Return the speed at which it can brake before its rim leaves these zones; inf if it drives into them."""
        point = pose.x, pose.y
        inside = [zone for zone in zones if zone.contains(point)]
        if not inside:  # somebody put it there
            return inf if _gap(zones, _ahead(point, direction, _PROBE)) < _gap(zones, point) else 0.0
        if max(edge_distance(zone, point) for zone in inside) > _LOOK + self._radius:
            return inf
        for step in range(round(_LOOK / _PROBE)):
            if not self._holds(zones, _ahead(point, direction, step * _PROBE), direction):
                if not step and _gap(inside, _ahead(point, direction, _PROBE)) > _gap(inside, point):
                    return inf
                return sqrt(2 * self._brake * max(0.0, step - 1) * _PROBE)
        return inf

    def _holds(self, zones: Sequence[Zone], centre: Point, direction: Point) -> bool:
        """Return whether the front half of the rim is in the zones."""
        reach, (dx, dy) = self._radius + _EDGE, direction
        rim = ((centre[0] + reach * (dx * c - dy * s), centre[1] + reach * (dx * s + dy * c)) for c, s in _RIM)
        return all(any(zone.contains(point) for zone in zones) for point in rim)


def _ahead(point: Point, direction: Point, way: float) -> Point:
    return point[0] + way * direction[0], point[1] + way * direction[1]


def _gap(zones: Sequence[Zone], point: Point) -> float:
    return min(edge_distance(zone, point) for zone in zones)


def _box(zone: Zone, margin: float) -> Segment:
    """Return the smallest and largest x and y of a zone with so many metres around it."""
    xs, ys = [x for x, _ in zone.points], [y for _, y in zone.points]
    return min(xs) - margin, min(ys) - margin, max(xs) + margin, max(ys) + margin


def _within(box: Segment, pose: Pose) -> bool:
    return box[0] <= pose.x <= box[2] and box[1] <= pose.y <= box[3]


def edge_distance(zone: Zone, point: Point) -> float:
    """Return the metres from a point to the border of a zone."""
    return min(segment_distance(point, (*a, *b)) for a, b in edges(zone.points))

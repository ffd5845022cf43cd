"""How fast it is safe to drive: walking people and zones limit the base, whatever the command."""

from __future__ import annotations

from math import cos, hypot, inf, radians, sin, sqrt

from btlang.robots.body import Body
from btlang.robots.geometry import Point, Pose, Segment, edges, segment_distance
from btlang.robots.obstacles import Obstacles
from btlang.robots.world import Zone
from btlang.robots.zones import Zones

_MARGIN = 0.08  # metres that stay free
_APPROACH = 0.6  # metres a second at which people may come nearer while it brakes; they look where they go
_DELAY = 0.05  # seconds until it brakes
_AHEAD = cos(radians(75.0))
_LOOK = 2.0  # metres
_EDGE = 0.02  # metres that stay free before a zone
_PROBE = 0.05  # metres ahead


class Protection:
    """Limits the base of a robot, so that it stands before somebody who walks reaches it, and before closed zones."""

    def __init__(self, obstacles: Obstacles, zones: Zones, body: Body) -> None:
        self._obstacles, self._zones = obstacles, zones
        self._radius, self._brake = body.radius, body.driving.brake
        self._slow: list[tuple[Zone, Segment]] = []
        self._closed: list[tuple[Zone, Segment]] = []
        self._version = -1
        self.person = ""
        """Who makes it stand, or nearly so; "" where nobody does."""
        self.zone: Zone | None = None
        """The zone that makes it stand."""

    def limit(self, pose: Pose, backward: bool = False) -> float:
        """Metres a second that are safe straight ahead, or backward; inf where nothing limits it."""
        self.person, self.zone = "", None
        if self._version != self._zones.version:
            self._measure()
        most = inf
        for zone, box in self._slow:
            if zone.speed < most and _within(box, pose) and self._near(zone, (pose.x, pose.y)):
                most = zone.speed
        closed = [zone for zone, box in self._closed if _within(box, pose)]
        if not closed and not self._obstacles.walking:
            return most
        heading = radians(pose.heading + 180.0 * backward)
        direction = cos(heading), sin(heading)
        most = min(most, self._for_people(pose, direction))
        for zone in closed:
            free = self._before(zone, pose, direction)
            if free < most:
                most, self.person = free, ""
                self.zone = zone if free < _MARGIN else None
        return most

    def _measure(self) -> None:
        """Notes in which boxes the zones matter: most of the time the robot is in none."""
        self._version = self._zones.version
        self._slow = [(zone, _box(zone, self._radius)) for zone in self._zones.slow]
        self._closed = [(zone, _box(zone, self._radius + _EDGE + _LOOK)) for zone in self._zones.closed]

    def _for_people(self, pose: Pose, direction: Point) -> float:
        most = inf
        for name, (x, y, radius) in self._obstacles.walking.items():
            dx, dy = x - pose.x, y - pose.y
            if abs(dx) > _LOOK or abs(dy) > _LOOK:
                continue
            distance = hypot(dx, dy)
            if dx * direction[0] + dy * direction[1] < _AHEAD * distance:
                continue
            gap = distance - radius - self._radius - _MARGIN
            safe = self._before_contact(gap)
            if safe < most and not self._obstacles.wall_between((pose.x, pose.y), (x, y)):
                most = safe
                self.person = name if safe < 0.1 else self.person
        return most

    def _before_contact(self, gap: float) -> float:
        """The speed at which it stands before somebody who comes nearer meanwhile has made up the gap."""
        if gap <= 0.0:
            return 0.0
        lost = _APPROACH + _DELAY * self._brake
        return sqrt(lost * lost + 2 * self._brake * gap) - lost

    def _near(self, zone: Zone, point: Point) -> bool:
        return zone.contains(point) or edge_distance(zone, point) < self._radius

    def _before(self, zone: Zone, pose: Pose, direction: Point) -> float:
        """The speed at which it can brake before the zone; inf where it drives away from it, or out of it."""
        point = pose.x, pose.y
        gap = edge_distance(zone, point) - self._radius - _EDGE
        if gap > _LOOK or zone.contains(point):
            return inf
        ahead = pose.x + _PROBE * direction[0], pose.y + _PROBE * direction[1]
        nearer = edge_distance(zone, point) - edge_distance(zone, ahead)
        if nearer <= 0.0 and not zone.contains(ahead):
            return inf
        return sqrt(2 * self._brake * max(0.0, gap) * _PROBE / max(nearer, 1e-9)) if gap > 0.0 else 0.0


def _box(zone: Zone, margin: float) -> Segment:
    """The least and the greatest x and y of a zone with so many metres around it."""
    xs, ys = [x for x, _ in zone.points], [y for _, y in zone.points]
    return min(xs) - margin, min(ys) - margin, max(xs) + margin, max(ys) + margin


def _within(box: Segment, pose: Pose) -> bool:
    return box[0] <= pose.x <= box[2] and box[1] <= pose.y <= box[3]


def edge_distance(zone: Zone, point: Point) -> float:
    """Metres from a point to the border of a zone."""
    return min(segment_distance(point, (*a, *b)) for a, b in edges(zone.points))

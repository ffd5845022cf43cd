"""Poses and plane geometry in metres and degrees, without numpy: world files are checked with it at compile time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import atan2, cos, degrees, hypot, radians, sin

from btlang.support.record import Record

Point = tuple[float, float]
Segment = tuple[float, float, float, float]


def wrap(angle: float) -> float:
    """Return the same direction in (-180, 180] degrees."""
    wrapped = angle % 360.0
    return wrapped - 360.0 if wrapped > 180.0 else wrapped


class Pose(Record):
    """Metres east and north of the world's origin, and the heading in degrees, counter-clockwise from east."""

    x: float
    y: float
    heading: float = 0.0

    def distance_to(self, point: Point) -> float:
        """Return the metres in a straight line."""
        return hypot(point[0] - self.x, point[1] - self.y)

    def bearing_to(self, point: Point) -> float:
        """Return the degrees to turn (left positive) to face the point, in (-180, 180]."""
        return wrap(degrees(atan2(point[1] - self.y, point[0] - self.x)) - self.heading)

    def ahead(self, forward: float, left: float = 0.0) -> Point:
        """Return the point so many metres ahead and to the left."""
        c, s = cos(radians(self.heading)), sin(radians(self.heading))
        return self.x + forward * c - left * s, self.y + forward * s + left * c

    @property
    def inverse(self) -> Pose:
        """The pose of the origin, as seen from here."""
        c, s = cos(radians(self.heading)), sin(radians(self.heading))
        return Pose(-self.x * c - self.y * s, self.x * s - self.y * c, -self.heading)

    def progress_of(self, other: Pose) -> float:
        """Return how many metres `other` lies ahead of this pose (negative: behind)."""
        heading = radians(self.heading)
        return (other.x - self.x) * cos(heading) + (other.y - self.y) * sin(heading)


CENTRE = Pose(0.0, 0.0)


def segment_distance(point: Point, segment: Segment) -> float:
    """Metres from the point to the nearest point of the segment."""
    x, y = point
    ax, ay, bx, by = segment
    dx, dy = bx - ax, by - ay
    length2 = dx * dx + dy * dy
    t = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / length2)) if length2 else 0.0
    return hypot(x - ax - t * dx, y - ay - t * dy)


def centre_of(points: Sequence[Point]) -> Point:
    """Return the mean of some points."""
    xs, ys = zip(*points, strict=True)
    return sum(xs) / len(xs), sum(ys) / len(ys)


def edges(polygon: Sequence[Point]) -> Iterator[tuple[Point, Point]]:
    """Return the sides of a polygon, including the one from its last point to its first."""
    return zip(polygon, (*polygon[1:], polygon[0]), strict=True)


def contains(polygon: Sequence[Point], point: Point) -> bool:
    """Return whether a point is in a polygon, by the even-odd rule."""
    x, y = point
    inside = False
    for (ax, ay), (bx, by) in edges(polygon):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return inside

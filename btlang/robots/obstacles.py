"""All that the robot can run into: fixed segments, and the discs of objects and people, which may move."""

from __future__ import annotations

from math import hypot, inf, sqrt

from btlang.robots.geometry import Point, Segment
from btlang.robots.world import Box, Thing, World


class Obstacles:
    """The obstacles of one run. `version` changes whenever something moves, so that others may cache.

    `discs` are x, y and radius of each thing that stands on the floor. Plain numbers: numpy costs more to import than
    most runs take, so that only what scans or plans imports it.
    """

    def __init__(self, world: World) -> None:
        self.version = 0
        self.things: dict[str, Thing] = {thing.name: thing for thing in (*world.objects, *world.people)}
        self.segments: tuple[Segment, ...] = world.segments()
        self.boxes: tuple[Box, ...] = world.boxes
        self.discs: list[tuple[float, float, float]] = []
        self._walls = world.wall_segments()
        self._spans = [(ax, ay, bx - ax, by - ay, _length2(bx - ax, by - ay)) for ax, ay, bx, by in self.segments]
        self._carried: set[str] = set()
        self._names: list[str] = []
        self._collect_discs()

    def move(self, name: str, x: float, y: float) -> None:
        """Puts an object or a person somewhere else. Raises KeyError for an unknown name."""
        self.things[name] = self.things[name].replace(x=x, y=y)
        self._collect_discs()

    def pick_up(self, name: str) -> None:
        """Takes an object off the floor: it is no obstacle while carried."""
        self._carried.add(name)
        self._collect_discs()

    def put_down(self, name: str, x: float, y: float) -> None:
        """The opposite of `pick_up`."""
        self._carried.discard(name)
        self.move(name, x, y)

    def is_carried(self, name: str) -> bool:
        """Whether the robot holds it."""
        return name in self._carried

    def nearest(self, x: float, y: float) -> tuple[float, str]:
        """Metres from the point to the nearest surface, and the name of what it is ("a wall" if fixed)."""
        distance, name = inf, "nothing"
        if self._spans:
            distance, name = self._to_segments(x, y), "a wall"
        for (disc_x, disc_y, radius), thing in zip(self.discs, self._names, strict=True):
            gap = hypot(disc_x - x, disc_y - y) - radius
            if gap < distance:
                distance, name = gap, thing
        return distance, name

    def wall_between(self, a: Point, b: Point) -> bool:
        """True when a wall (not furniture) crosses the straight line from a to b."""
        dx, dy = b[0] - a[0], b[1] - a[1]
        for start_x, start_y, end_x, end_y in self._walls:
            span_x, span_y = end_x - start_x, end_y - start_y
            fx, fy = start_x - a[0], start_y - a[1]
            cross = dx * span_y - dy * span_x
            if abs(cross) < 1e-12:
                continue
            if 0 <= (fx * span_y - fy * span_x) / cross <= 1 and 0 <= (fx * dy - fy * dx) / cross <= 1:
                return True
        return False

    def _to_segments(self, x: float, y: float) -> float:
        nearest2 = inf
        for ax, ay, dx, dy, length2 in self._spans:
            fx, fy = x - ax, y - ay
            t = min(1.0, max(0.0, (fx * dx + fy * dy) / length2))
            gap2 = (fx - t * dx) ** 2 + (fy - t * dy) ** 2
            if gap2 < nearest2:
                nearest2 = gap2
        return sqrt(nearest2)

    def _collect_discs(self) -> None:
        self.version += 1
        standing = [thing for thing in self.things.values() if thing.name not in self._carried]
        self._names = [thing.name for thing in standing]
        self.discs = [(thing.x, thing.y, thing.radius) for thing in standing]


def _length2(dx: float, dy: float) -> float:
    return max(dx * dx + dy * dy, 1e-12)

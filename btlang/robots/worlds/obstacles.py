"""Everything that the robot can run into: walls, furniture, objects, and people, who may walk."""

from __future__ import annotations

from math import cos, hypot, inf, radians, sin, sqrt

from btlang.robots.geometry import Point, Segment
from btlang.robots.worlds.world import Door, FurnitureBox, Thing, World

Disc = tuple[float, float, float]
"""The x, y and radius of a disc."""


class Obstacles:
    """The obstacles of one run.

    `version` changes whenever something moves, so that others may cache; `layout` only when something that stands still
    does, and `walls` when a door does. `discs` are those of things on the floor, `walking` those of people who move by
    themselves.

    Plain numbers: numpy costs more to import than most runs take, so that only what scans or plans imports it.
    """

    def __init__(self, world: World) -> None:
        self.version = self.layout = self.walls = 0
        self.things: dict[str, Thing] = {thing.name: thing for thing in (*world.objects, *world.people)}
        self.doors: dict[str, Door] = {door.name: door for door in world.doors}
        self.boxes: tuple[FurnitureBox, ...] = world.boxes
        self.segments: tuple[Segment, ...] = ()
        self.discs: list[Disc] = []
        self.walking: dict[str, Disc] = {}
        self._edges = tuple(edge for box in world.boxes for edge in box.edges())
        self._standing_walls = world.wall_segments()
        self._walls: tuple[Segment, ...] = ()
        self._spans: list[tuple[float, float, float, float, float]] = []
        self._carried: set[str] = set()
        self._away = {person.name for person in world.people if person.moves}
        self._names: list[str] = []
        self._collect_walls()
        self._collect_discs()

    def move(self, name: str, x: float, y: float) -> None:
        """Put an object or a person who stands somewhere else. Raises KeyError for an unknown name."""
        self.things[name] = self.things[name].replace(x=x, y=y)
        self._collect_discs()

    def walk(self, discs: dict[str, Disc]) -> None:
        """Set where everybody who walks is now."""
        self.walking = discs
        self.version += 1

    def add(self, thing: Thing) -> None:
        """Add somebody who walks, and whom the world doesn't know."""
        self.things[thing.name] = thing
        self._away.add(thing.name)

    def start_walking(self, name: str) -> None:
        """Let somebody who only stood so far walk from now on."""
        self._away.add(name)
        self._collect_discs()

    def pick_up(self, name: str) -> None:
        """Take an object off the floor: it is no obstacle while carried."""
        self._carried.add(name)
        self._collect_discs()

    def put_down(self, name: str, x: float, y: float) -> None:
        """Put an object down, as the opposite of `pick_up`."""
        self._carried.discard(name)
        self.move(name, x, y)

    def is_carried(self, name: str) -> bool:
        """Return whether the robot holds it."""
        return name in self._carried

    def point(self, name: str) -> Point | None:
        """Return where an object or a person is; None if it is carried, or they aren't there."""
        if name in self.walking:
            return self.walking[name][:2]
        if name in self._carried or name in self._away:
            return None
        return self.things[name].x, self.things[name].y

    def swing(self, name: str, is_open: bool) -> None:
        """Open or close a door. Raises KeyError for an unknown name."""
        self.doors[name] = self.doors[name].replace(open=is_open)
        self._collect_walls()

    def nearest(self, x: float, y: float) -> tuple[float, str]:
        """Return the metres from the point to the nearest surface, and its name ("a wall" if fixed)."""
        return min(self.nearest_standing(x, y), self.nearest_walking(x, y))

    def nearest_standing(self, x: float, y: float) -> tuple[float, str]:
        """Return the nearest like `nearest`, without people who walk."""
        distance, name = inf, "nothing"
        if self._spans:
            distance, name = self._to_segments(x, y), "a wall"
        for (disc_x, disc_y, radius), thing in zip(self.discs, self._names, strict=True):
            gap = hypot(disc_x - x, disc_y - y) - radius
            if gap < distance:
                distance, name = gap, thing
        return distance, name

    def nearest_walking(self, x: float, y: float) -> tuple[float, str]:
        """Return the nearest like `nearest`, only of people who walk."""
        distance, name = inf, "nothing"
        for person, (disc_x, disc_y, radius) in self.walking.items():
            gap = hypot(disc_x - x, disc_y - y) - radius
            if gap < distance:
                distance, name = gap, person
        return distance, name

    def free_way(self, x: float, y: float, heading: float, radius: float) -> float:
        """Return the metres that a disc can move from a point in a direction (degrees) until it touches something, else
        inf.
        """
        c, s = cos(radians(heading)), sin(radians(heading))
        free = inf
        for disc_x, disc_y, disc_radius in (*self.discs, *self.walking.values()):
            ahead, left = (disc_x - x) * c + (disc_y - y) * s, (disc_y - y) * c - (disc_x - x) * s
            reach = radius + disc_radius
            if ahead > 0.0 and abs(left) < reach:
                free = min(free, ahead - sqrt(reach * reach - left * left))
        for ax, ay, bx, by in self.segments:
            left_a, left_b = (ay - y) * c - (ax - x) * s, (by - y) * c - (bx - x) * s
            if (left_a >= radius and left_b >= radius) or (left_a <= -radius and left_b <= -radius):
                continue
            ahead_a, ahead_b = (ax - x) * c + (ay - y) * s, (bx - x) * c + (by - y) * s
            if ahead_a > 0.0 or ahead_b > 0.0:
                free = min(free, _to_segment(ahead_a, left_a, ahead_b, left_b, radius))
        return max(0.0, free)

    def wall_between(self, a: Point, b: Point) -> bool:
        """Return whether a wall or a closed door (not furniture) crosses the straight line from a to b."""
        dx, dy = b[0] - a[0], b[1] - a[1]
        for start_x, start_y, end_x, end_y in self._walls:
            span_x, span_y = end_x - start_x, end_y - start_y
            fx, fy = start_x - a[0], start_y - a[1]
            cross = dx * span_y - dy * span_x
            if abs(cross) < 1e-12:
                continue  # parallel
            t, u = (fx * span_y - fy * span_x) / cross, (fx * dy - fy * dx) / cross
            if 0.0 <= t <= 1.0 and 0.0 <= u <= 1.0:
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

    def _collect_walls(self) -> None:
        closed = [(*door.start, *door.end) for door in self.doors.values() if not door.open]
        self._walls = (*self._standing_walls, *closed)
        self.segments = (*self._walls, *self._edges)
        self._spans = [(ax, ay, bx - ax, by - ay, _length2(bx - ax, by - ay)) for ax, ay, bx, by in self.segments]
        self.version += 1
        self.layout += 1
        self.walls += 1

    def _collect_discs(self) -> None:
        self.version += 1
        self.layout += 1
        standing = [
            thing for thing in self.things.values() if thing.name not in self._carried and thing.name not in self._away
        ]
        self._names = [thing.name for thing in standing]
        self.discs = [(thing.x, thing.y, thing.radius) for thing in standing]


def _to_segment(ax: float, ay: float, bx: float, by: float, radius: float) -> float:
    """Return the metres that a disc at the origin can move along x until it touches a segment."""
    ends = ((ax, ay), (bx, by))
    free = min((x - sqrt(radius * radius - y * y) for x, y in ends if x > 0.0 and abs(y) < radius), default=inf)
    dx, dy = bx - ax, by - ay
    length = hypot(dx, dy)
    if dy == 0.0 or length == 0.0:
        return free  # it moves along the segment, and can only touch an end of it
    nx, ny = -dy / length, dx / length
    if nx > 0.0:
        nx, ny = -nx, -ny  # towards the disc
    way = (radius + nx * ax + ny * ay) / nx
    touched_x, touched_y = way - radius * nx, -radius * ny
    share = ((touched_x - ax) * dx + (touched_y - ay) * dy) / (length * length)
    return min(free, way) if 0.0 <= share <= 1.0 and touched_x > 0.0 else free


def _length2(dx: float, dy: float) -> float:
    return max(dx * dx + dy * dy, 1e-12)

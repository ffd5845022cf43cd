"""The world from above: walls, furniture, places, people, zones, doors and routes, with labels in free spots."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np

from btlang.pictures import letters
from btlang.pictures.surface import INK, SMALL, SOFT
from btlang.robots.geometry import Point, edges
from btlang.robots.worlds.world import AREA, Door, Lane, Person, Thing, World, Zone
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

    from btlang.pictures.surface import Surface


_DIRECTIONS = 16
_RINGS = (0.0, 7.0, 16.0, 28.0, 44.0, 66.0)  # further and further from the point
_OUTSIDE = 1e4
_OVERLAP = 60.0  # that there is one at all
_PER_POINT = 6.0  # cost of a point of a line below the label, in square points of overlap


class Area(Record):
    """A rectangle in points."""

    x: float
    y: float
    width: float
    height: float

    @property
    def middle(self) -> tuple[float, float]:
        """Return its centre."""
        return self.x + self.width / 2, self.y + self.height / 2

    def overlap(self, other: Area) -> float:
        """Return the square points that both cover."""
        across = min(self.x + self.width, other.x + other.width) - max(self.x, other.x)
        down = min(self.y + self.height, other.y + other.height) - max(self.y, other.y)
        return across * down if across > 0 and down > 0 else 0.0


class Placer:
    """A finder of free spots for labels, which go within `sheet`.

    What is `taken` is not covered if there is room elsewhere, lines are avoided.
    """

    def __init__(self, sheet: Area) -> None:
        self._sheet = sheet
        self.taken: list[Area] = []
        self._points: npt.NDArray[np.float64] = np.zeros((0, 2))

    def avoid(self, points: Iterable[tuple[float, float]]) -> None:
        """Add points of lines that labels should not hide."""
        self._points = np.concatenate([self._points, np.array(list(points), dtype=float).reshape(-1, 2)])

    def place(self, x: float, y: float, width: float, height: float, gap: float) -> tuple[Area, float]:
        """Return the best area of that size at least `gap` away from the point, now taken, and how much it overlaps."""
        best, least, overlap = Area(x, y, width, height), float("inf"), 0.0
        for ring in _RINGS:
            for step in range(_DIRECTIONS):
                area = _beside(x, y, width, height, gap + ring, 2 * pi * step / _DIRECTIONS)
                covered = self._cover(area)
                cost = (
                    (_OVERLAP + 4 * covered if covered else 0)
                    + self._hidden(area)
                    + 1.5 * ring
                    + (0 if step % 4 == 0 else 1)
                )
                if cost < least:
                    best, least, overlap = area, cost, covered
            if least < 1.5 * ring + 2:  # further out it cannot be better
                break
        self.taken.append(best)
        return best, overlap

    def _cover(self, area: Area) -> float:
        sheet = self._sheet
        inside = area.overlap(sheet) >= area.width * area.height - 1e-6
        return sum(area.overlap(other) for other in self.taken) + (0.0 if inside else _OUTSIDE)

    def _hidden(self, area: Area) -> float:
        xs, ys = self._points[:, 0], self._points[:, 1]
        within = (xs > area.x) & (xs < area.x + area.width) & (ys > area.y) & (ys < area.y + area.height)
        return _PER_POINT * float(np.count_nonzero(within))


def _beside(x: float, y: float, width: float, height: float, gap: float, angle: float) -> Area:
    """Return the area whose nearest edge is `gap` away from the point in a direction."""
    dx, dy = cos(angle), sin(angle)
    return Area(x + dx * (gap + width / 2) - width / 2, y + dy * (gap + height / 2) - height / 2, width, height)


def along(points: list[tuple[float, float]], step: float) -> list[tuple[float, float]]:
    """Return points on a line, one for each `step` of its length, with both ends."""
    found = points[:1]
    left = step
    for (ax, ay), (bx, by) in pairwise(points):
        length = hypot(bx - ax, by - ay)
        at = left
        while at <= length and length > 0:
            found.append((ax + (bx - ax) * at / length, ay + (by - ay) * at / length))
            at += step
        left = at - length
    return found + points[-1:]


_CLOSED_ZONE, _SLOW_ZONE = "#c0440c", "#9a6a00"
DOOR_COLOUR, _ROUTE, _LANE = "#2f6f8f", "#cc79a7", "#7a9e87"
_ARROW = 5.0  # points
_GAP, _HATCH = 5.0, 7.0  # points between the dots of a route, and between the lines of a zone

At = Callable[[float, float], tuple[float, float]]
"""A function from metres to points of the canvas."""


def find_shown_zones(world: World) -> list[Zone]:
    """Return the zones without those that are only the region of a place: walls show where it ends."""
    places = {place.name for place in world.places}
    return [zone for zone in world.zones if zone.kind != AREA or zone.name not in places]


def draw_zones(canvas: Surface, world: World, at: At) -> None:
    """Draw slow zones in yellow, and those to keep out of in red and hatched."""
    for zone in find_shown_zones(world):
        corners = [at(*point) for point in zone.points]
        if zone.is_closed:
            canvas.polygon(corners, fill="#fbdccb", edge=_CLOSED_ZONE, line=0.9)
            for line in hatch(corners, _HATCH):
                canvas.line(line, colour=_CLOSED_ZONE, line=0.5, round=False)
        else:
            canvas.polygon(corners, fill="#fff3c4", edge=_SLOW_ZONE, line=0.9)


def zone_colour(zone: Zone) -> str:
    """Return the colour of a zone's name."""
    return _CLOSED_ZONE if zone.is_closed else _SLOW_ZONE


def middle_of(zone: Zone) -> Point:
    """Return a point in the zone for its name: the middle of its corners."""
    xs, ys = [x for x, _ in zone.points], [y for _, y in zone.points]
    return sum(xs) / len(xs), sum(ys) / len(ys)


def hatch(corners: Sequence[Point], step: float) -> list[list[Point]]:
    """Return lines that rise to the right, so far apart, where they are in a polygon."""
    found = []
    sums = [x + y for x, y in corners]
    along = (int(min(sums) // step) + 1) * step
    while along < max(sums):
        crossings = []
        for (ax, ay), (bx, by) in edges(corners):
            a, b = ax + ay - along, bx + by - along
            if (a > 0) != (b > 0):
                share = a / (a - b)
                crossings.append((ax + share * (bx - ax), ay + share * (by - ay)))
        crossings.sort()
        found += [list(pair) for pair in zip(crossings[::2], crossings[1::2], strict=True)]
        along += step
    return found


def draw_door(canvas: Surface, door: Door, at: At, middle: Point) -> None:
    """Draw a door: closed a bar in the wall; open its leaf, at a right angle to the wall, towards the middle of the
    canvas.
    """
    start, end = at(*door.start), at(*door.end)
    if not door.open:
        canvas.line([start, end], colour="white", line=4.2, round=False)
        canvas.line([start, end], colour=DOOR_COLOUR, line=3.0, round=False)
        return
    across, down = start[1] - end[1], end[0] - start[0]
    leaves = ((start[0] + side * across, start[1] + side * down) for side in (1, -1))
    leaf = min(leaves, key=lambda leaf: hypot(leaf[0] - middle[0], leaf[1] - middle[1]))
    canvas.line([start, end], colour=DOOR_COLOUR, line=0.7, dashed=True)
    canvas.line([start, leaf], colour=DOOR_COLOUR, line=2.0, round=False)


def draw_lanes(canvas: Surface, lanes: Iterable[Lane], at: At) -> None:
    """Draw lanes as thin lines, with an arrow in the middle of those that lead one way."""
    for lane in lanes:
        start, end = at(*lane.start), at(*lane.end)
        canvas.line([start, end], colour=_LANE, line=0.7)
        length = hypot(end[0] - start[0], end[1] - start[1])
        if lane.one_way and length > 0:
            x, y = (end[0] - start[0]) * _ARROW / length, (end[1] - start[1]) * _ARROW / length
            tip = (start[0] + end[0] + x) / 2, (start[1] + end[1] + y) / 2
            wings = (tip[0] - x - y / 2, tip[1] - y + x / 2), (tip[0] - x + y / 2, tip[1] - y - x / 2)
            canvas.polygon([tip, *wings], fill=_LANE)


def draw_route(canvas: Surface, person: Person, at: At) -> None:
    """Draw dots from where somebody begins to each stop, and back to the first one where the route is walked again."""
    stops = [(person.x, person.y), *((stop.x, stop.y) for stop in person.walks)]
    if person.again and len(stops) > 2:
        stops.append(stops[1])
    for a, b in pairwise([at(*stop) for stop in stops]):
        steps = max(int(hypot(b[0] - a[0], b[1] - a[1]) / _GAP), 1)
        for step in range(1, steps + 1):
            share = step / steps
            canvas.circle(a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, 0.9, fill=_ROUTE)
    for stop in stops[1:]:
        canvas.circle(*at(*stop), 2.2, fill="white", edge=_ROUTE, line=0.9)


_WALL, _FURNITURE, _FLOOR = "#3d4750", "#d9d2c5", "#fafaf7"
_PLACE, _PERSON, OBJECT = "#5b6b7a", "#cc79a7", "#7a4f9e"
_LARGEST = 110.0  # points a metre
_ROUND = 0.35  # metres around everything
_LEAST = (4.0, 2.5)  # metres that a map shows
_LONGEST_NAME = 110.0


class WorldMap:
    """A map on a canvas within `room`; `area` is what it takes of it.

    The world is scaled to fit. `track` are further points that have to be on the map.
    """

    def __init__(self, world: World, room: Area, track: Iterable[Point] = ()) -> None:
        self._world = world
        points = [(world.start.x, world.start.y), *track, *(point for wall in world.walls for point in wall)]
        points += [edge[:2] for box in world.boxes for edge in box.edges()]
        points += [(place.x, place.y) for place in world.places]
        points += [(thing.x, thing.y) for thing in (*world.objects, *world.people)]
        points += [(stop.x, stop.y) for person in world.people for stop in person.walks]
        points += [point for zone in world.zones for point in zone.points]
        points += [point for door in world.doors for point in (door.start, door.end)]
        points += [point for lane in world.lanes for point in (lane.start, lane.end)]
        xs, ys = [x for x, _ in points], [y for _, y in points]
        width = max(max(xs) - min(xs) + 2 * _ROUND, _LEAST[0])
        height = max(max(ys) - min(ys) + 2 * _ROUND, _LEAST[1])
        left, low = (max(xs) + min(xs) - width) / 2, (max(ys) + min(ys) - height) / 2
        self.scale = min(room.width / width, room.height / height, _LARGEST)
        self.area = Area(room.x, room.y, width * self.scale, height * self.scale)
        self._left, self._top = left, low + height

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return points of the canvas, of metres."""
        return self.area.x + (x - self._left) * self.scale, self.area.y + (self._top - y) * self.scale

    def draw(self, canvas: Surface, walked: Container[str] = ()) -> None:
        """Draw the floor, zones, lanes, walls, doors and furniture, and a ring and the route of each person.

        The rings of those who have `walked` away are dashed.
        """
        world, s = self._world, self.scale
        canvas.box(self.area.x, self.area.y, self.area.width, self.area.height, round=4, fill=_FLOOR)
        draw_zones(canvas, world, self.at)
        draw_lanes(canvas, world.lanes, self.at)
        for box in world.boxes:
            x, y = self.at(box.x - box.width / 2, box.y + box.height / 2)
            canvas.box(x, y, box.width * s, box.height * s, round=1.5, fill=_FURNITURE, edge="#b3aa98", line=0.8)
        for wall in world.walls:
            canvas.line([self.at(*point) for point in wall], colour=_WALL, line=2.6)
        for door in world.doors:
            draw_door(canvas, door, self.at, self.area.middle)
        for person in world.people:
            draw_route(canvas, person, self.at)
        for person in world.people:
            x, y = self.at(person.x, person.y)
            if person.name in walked:
                canvas.circle(x, y, person.radius * s, fill="white", edge=_PERSON, dashed=True)
                continue
            canvas.circle(x, y, person.radius * s, fill="#f3dcea", edge=_PERSON)
            canvas.circle(x, y, max(person.radius * s * 0.45, 2.0), fill=_PERSON)

    def draw_names(self, canvas: Surface, placer: Placer, moved: Mapping[str, Point | None] = {}) -> None:
        """Mark and names of what is in the world; `moved` says where objects lie in the end."""
        for zone in find_shown_zones(self._world):
            x, y = self.at(*middle_of(zone))
            text = letters.clip_text(letters.make_printable(zone.name), _LONGEST_NAME, SMALL)
            canvas.text(x, y, text, size=SMALL, colour=zone_colour(zone), align="center", halo=True, z=1.5)
            width = letters.width(text, SMALL)
            placer.taken.append(Area(x - width / 2, y - SMALL / 2, width, SMALL))
        for place in self._world.places:
            x, y = self.at(place.x, place.y)
            if place in self._world.all_docks:
                canvas.box(x - 5, y - 5, 10, 10, round=2.5, fill="#ffe08a", edge="#8a6d00", line=0.9, z=3)
                canvas.text(x, y, "⚡", size=8, colour="#5c4900", align="center", z=3)
                placer.taken.append(Area(x - 5, y - 5, 10, 10))
            else:
                canvas.polygon([(x - 3.2, y), (x, y - 3.2), (x + 3.2, y), (x, y + 3.2)], fill="white", edge=_PLACE, z=3)
                placer.taken.append(Area(x - 3, y - 3, 6, 6))
        for place in self._world.places:
            self._name(canvas, placer, place.name, self.at(place.x, place.y), _PLACE, 6.5)
        for person in self._world.people:
            radius = person.radius * self.scale
            x, y = self.at(person.x, person.y)
            placer.taken.append(Area(x - radius, y - radius, 2 * radius, 2 * radius))
            self._name(canvas, placer, person.name, (x, y), "#9c3f74", radius + 1.5)
        for thing in self._world.objects:
            self._object(canvas, placer, thing, moved)
        for door in self._world.doors:
            self._name(canvas, placer, door.name, self.at(*door.middle), DOOR_COLOUR, 4.0)

    def _object(self, canvas: Surface, placer: Placer, thing: Thing, moved: Mapping[str, Point | None]) -> None:
        radius = max(thing.radius * self.scale, 2.6)
        x, y = self.at(thing.x, thing.y)
        if thing.name in moved:
            canvas.circle(x, y, radius, fill="white", edge=OBJECT, line=0.8, dashed=True)
            placer.taken.append(Area(x - radius, y - radius, 2 * radius, 2 * radius))
            self._name(canvas, placer, thing.name, (x, y), SOFT, radius + 1.5)
            place = moved[thing.name]
            if place is None:
                return
            x, y = self.at(*place)
        canvas.circle(x, y, radius, fill=OBJECT, edge="white", line=0.6, z=4)
        placer.taken.append(Area(x - radius, y - radius, 2 * radius, 2 * radius))
        self._name(canvas, placer, thing.name, (x, y), OBJECT, radius + 1.5)

    def _name(
        self, canvas: Surface, placer: Placer, name: str, at: tuple[float, float], colour: str, gap: float
    ) -> None:
        text = letters.clip_text(letters.make_printable(name), _LONGEST_NAME, SMALL)
        area, _ = placer.place(*at, letters.width(text, SMALL), SMALL + 1, gap)
        x, y = area.middle
        canvas.text(x, y, text, size=SMALL, colour=colour, align="center", halo=True, z=3)

    def lines(self) -> list[tuple[float, float]]:
        """Return points on all walls, for labels to keep away from."""
        return [point for wall in self._world.walls for point in along([self.at(*p) for p in wall], 5.0)]

    def draw_scale(self, canvas: Surface, x: float, y: float) -> float:
        """Return a bar of a round length; returns the width that it takes."""
        metres = next(m for m in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 1e9) if m * self.scale >= 40)
        length, text = metres * self.scale, f"{metres:g} m"
        if length > 200:  # a world of one point
            return 0.0
        canvas.line([(x, y - 3), (x, y), (x + length, y), (x + length, y - 3)], colour=INK, line=1.1)
        canvas.text(x + length + 5, y - 2, text, size=SMALL, colour=SOFT)
        return length + 5 + letters.width(text, SMALL)

"""Buildings of Open-RMF (building.yaml): the walls, doors, lanes, chargers, lifts and named points of one level."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot

from btlang.maps.data_text import number, shown
from btlang.maps.route_graph import join_lanes
from btlang.maps.way_points import place_name
from btlang.robots.geometry import Point, Pose, Segment
from btlang.robots.worlds.world import Door, Lane, Place
from btlang.support.record import Record
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 100_000  # vertices, walls and doors of a level
_IMAGE, _METRES = "reference_image", "cartesian_meters"


class Building(Record):
    """A level of a building in metres. `chargers` are the names of places where robots charge."""

    walls: tuple[tuple[Point, ...], ...]
    doors: tuple[Door, ...]
    places: tuple[Place, ...]
    chargers: frozenset[str]
    start: Pose | None
    level: str
    lanes: tuple[Lane, ...]


def is_building(data: object) -> bool:
    """Return whether the data of a file are a building."""
    return isinstance(data, Mapping) and isinstance(data.get("levels"), Mapping)


def read_building(data: Mapping[str, Any], level: str | None) -> Building:
    """Return a level of a building, by default its only one. Raises Problem."""
    levels = data["levels"]
    names = [str(name) for name in levels]
    if level is None and len(names) > 1:
        raise Problem(f"the building has the levels {', '.join(names)}; choose one with --level {names[0]}")
    chosen = names[0] if level is None and names else level
    found = next((value for name, value in levels.items() if str(name) == chosen), None)
    if not isinstance(found, Mapping):
        raise Problem(f"there is no level {shown(chosen)}; there are: {', '.join(names) or 'none'}")
    system = data.get("coordinate_system", _IMAGE)
    if system not in (_IMAGE, _METRES):
        raise Problem(f"coordinates in {shown(system)} can't be read; only {_IMAGE} and {_METRES} can")
    return _Level(str(chosen), found, is_image=system == _IMAGE).building(data.get("lifts"))


class _Level:
    def __init__(self, name: str, data: Mapping[str, Any], is_image: bool) -> None:
        self._name, self._data = name, data
        raw = [self._pair(vertex, at) for at, vertex in enumerate(self._rows("vertices"))]
        scale = self._scale(raw) if is_image else 1.0
        self._scale_x, self._scale_y = scale, -scale if is_image else 1.0  # images count down from the top
        self._points = [self._metres(point) for point in raw]

    def _rows(self, key: str) -> list[Any]:
        rows = self._data.get(key)
        if rows is not None and not isinstance(rows, list):
            raise Problem(f"{self._name}.{key} must be a list")
        if rows is not None and len(rows) > _MOST:
            raise Problem(f"{self._name}.{key} may have at most {_MOST:,} entries")
        return rows or []

    def _pair(self, vertex: Any, at: int) -> Point:
        where = f"{self._name}.vertices[{at}]"
        if not isinstance(vertex, list) or len(vertex) < 2:
            raise Problem(f"{where} must be a list [x, y, z, name]")
        return number(vertex[0], where), number(vertex[1], where)

    def _metres(self, point: Point) -> Point:
        return round(point[0] * self._scale_x, 4) + 0.0, round(point[1] * self._scale_y, 4) + 0.0  # no -0

    def _edges(self, key: str) -> Iterator[tuple[int, int, Mapping[str, Any]]]:
        """Yield the numbers of two vertices and the properties of each edge."""
        count = len(self._rows("vertices"))
        for at, edge in enumerate(self._rows(key)):
            ends = edge[:2] if isinstance(edge, list) else []
            if len(ends) < 2 or not all(isinstance(end, int) and 0 <= end < count for end in ends):
                raise Problem(f"{self._name}.{key}[{at}] must begin with the numbers of two vertices")
            yield ends[0], ends[1], edge[2] if len(edge) > 2 and isinstance(edge[2], Mapping) else {}

    def _scale(self, points: list[Point]) -> float:
        """Return the metres of a pixel, by what was measured on the drawing."""
        found = []
        for start, end, properties in self._edges("measurements"):
            metres = _value(properties, "distance")
            pixels = hypot(points[start][0] - points[end][0], points[start][1] - points[end][1])
            if isinstance(metres, int | float) and metres > 0 and pixels > 0:
                found.append(metres / pixels)
        if not found:
            raise Problem(f"the level {self._name} has no measurements, so the size of its drawing isn't known")
        return sum(found) / len(found)

    def building(self, lifts: Any) -> Building:
        walls = [self._segment(start, end) for start, end, _ in self._edges("walls")]
        places, chargers, start = self._places()
        places += self._lifts(lifts)
        lanes = join_lanes(self._ways())
        if start is None and not places and lanes:
            start = Pose(*lanes[0].start)
        return Building(
            tuple((wall[:2], wall[2:]) for wall in walls if wall[:2] != wall[2:]),
            tuple(self._doors()),
            tuple(places),
            frozenset(chargers),
            start,
            self._name,
            lanes,
        )

    def _ways(self) -> Iterator[tuple[Point, Point]]:
        for start, end, properties in self._edges("lanes"):
            yield self._points[start], self._points[end]
            if _value(properties, "bidirectional") is True:
                yield self._points[end], self._points[start]

    def _segment(self, start: int, end: int) -> Segment:
        return (*self._points[start], *self._points[end])

    def _doors(self) -> Iterator[Door]:
        taken: dict[str, int] = {}
        for start, end, properties in self._edges("doors"):
            if self._points[start] == self._points[end]:
                continue
            name = place_name(_value(properties, "name") or "door")
            taken[name.lower()] = number_of = taken.get(name.lower(), 0) + 1
            yield Door(name if number_of == 1 else f"{name} {number_of}", self._points[start], self._points[end])

    def _places(self) -> tuple[list[Place], list[str], Pose | None]:
        """Return the named vertices, the names of those with a charger, and where a robot starts."""
        places, chargers = list[Place](), list[str]()
        start: Pose | None = None
        for vertex, point in zip(self._rows("vertices"), self._points, strict=True):
            properties = vertex[4] if len(vertex) > 4 and isinstance(vertex[4], Mapping) else {}
            if start is None and _value(properties, "spawn_robot_name"):
                start = Pose(*point)
            if len(vertex) > 3 and vertex[3] not in ("", None):
                name = place_name(vertex[3])
                places.append(Place(name, *point))
                if _value(properties, "is_charger") is True:
                    chargers.append(name)
        return places, chargers, start

    def _lifts(self, lifts: Any) -> Iterator[Place]:
        """Yield a place in each lift that stops at this level."""
        for name, lift in lifts.items() if isinstance(lifts, Mapping) else ():
            doors = lift.get("level_doors") if isinstance(lift, Mapping) else None
            if isinstance(doors, Mapping) and doors.get(self._name):
                at = number(lift.get("x"), f"lifts.{name}.x"), number(lift.get("y"), f"lifts.{name}.y")
                yield Place(place_name(name), *self._metres(at), kind="lift")


def _value(properties: Mapping[str, Any], key: str) -> Any:
    """Return a property, which is written with the number of its type: `[4, true]`."""
    value = properties.get(key)
    return value[1] if isinstance(value, list) and len(value) == 2 else value

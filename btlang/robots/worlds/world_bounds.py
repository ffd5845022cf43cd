"""Finds what lies outside the outer walls of a world, if these are closed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from math import atan2, tau

from btlang.robots.geometry import Point, Segment, contains, edges, segment_distance
from btlang.robots.worlds.world import Person, World, Zone
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Path: TypeAlias = tuple[str | int, ...]
    Rows: TypeAlias = Mapping[str, Sequence[Any]]

_TOUCHING = 0.1  # metres; so near to the outer wall something is on it
_STEPS = 20  # points looked at on each side of a zone
_SINGLE = ("start", "dock")  # sections that are one table
_STANDING = {
    "start": "start", "places": "place", "dock": "place", "docks": "place", "objects": "object", "people": "person",
    "crowds": "person",
}  # fmt: skip

Polyline = tuple[Point, ...]


def closed_walls(world: World) -> list[Polyline]:
    """Return the outline of each group of walls and doors that meet at their corners, if it is closed around an area.

    Each corner of the way around is there as often as the way passes it. There are none if all outlines together are
    around less than half of the rectangle that holds the walls: closed rooms in a building that is open.
    """
    beside: dict[Point, set[Point]] = {}
    for wall in (*world.walls, *((door.start, door.end) for door in world.doors)):
        for one, other in pairwise(wall):
            if one != other:
                beside.setdefault(one, set()).add(other)
                beside.setdefault(other, set()).add(one)
    seen = set[Point]()
    outlines = []
    for corner in sorted(beside):
        if corner not in seen:  # the corner of a new group that is farthest west
            outlines.append(_outline(corner, beside))
            left = [corner]
            while left:
                at = left.pop()
                if at not in seen:
                    seen.add(at)
                    left += beside[at]
    closed = [outline for outline in outlines if _area(outline)]
    xs, ys = ([corner[axis] for corner in beside] for axis in (0, 1))
    whole = (max(xs) - min(xs)) * (max(ys) - min(ys)) if beside else 0.0
    return closed if sum(map(_area, closed)) >= whole / 2 else []


def _outline(first: Point, beside: Mapping[Point, set[Point]]) -> Polyline:
    """Return the way around a group of walls from its westernmost corner, always along the next one to the left."""
    found, passed, at, back = list[Point](), set[Segment](), first, (first[0] - 1.0, first[1])
    while True:
        behind = atan2(back[1] - at[1], back[0] - at[0])
        turns = {to: (atan2(to[1] - at[1], to[0] - at[0]) - behind) % tau or tau for to in sorted(beside[at])}
        to = min(turns, key=turns.__getitem__)
        if (*at, *to) in passed:  # once around; walls that lie on each other may cut the way short
            return tuple(found)
        passed.add((*at, *to))
        found.append(at)
        back, at = at, to


def is_outside(walls: Sequence[Polyline], point: Point) -> bool:
    """Return whether there are closed walls, but none around the point."""
    return bool(walls) and not any(contains(wall, point) for wall in walls)


def _area(outline: Polyline) -> float:
    """Return the square metres inside an outline."""
    return abs(sum(ax * by - bx * ay for (ax, ay), (bx, by) in edges(outline))) / 2


def entries(rows: Rows, sections: Iterable[str]) -> Iterator[tuple[Path, tuple[Any, ...]]]:
    """Return what the rows of these sections of a world file have made, and where each of them is in the file.

    `rows` has a list for each section, None for a wrong row. The people of a crowd are made by one row.
    """
    for section in sections:
        for index, row in enumerate(rows[section]):
            if row is not None:
                yield (section,) if section in _SINGLE else (section, index), row if isinstance(row, tuple) else (row,)


def spots(rows: Rows, sections: Iterable[str] = _STANDING) -> Iterator[tuple[str, Path, Any]]:
    """Return for each row of these sections its name in messages, its place in the file, and what has its x and y."""
    for path, (first, *_) in entries(rows, sections):
        kind = _STANDING[str(path[0])]
        yield f"the {kind}" if kind == "start" else f'the {kind} "{first.name}"', path, first


def outside(world: World, rows: Rows) -> Iterator[Problem]:
    """Return a Problem for each place, object, person, stop of a route, zone and door with no closed wall around it.

    `rows` are as those of `entries`.
    """
    walls = closed_walls(world)
    if not walls:
        return
    for what, path, point in _points(world, rows):
        if not _is_within(walls, point):
            yield Problem(f"{what} at ({point[0]:g}, {point[1]:g}) is outside the outer walls", *path)
    for path, (zone,) in entries(rows, ("zones",)):
        if not any(_reaches_into(zone, wall) for wall in walls):
            yield Problem(f'the zone "{zone.name}" is outside the outer walls', *path, "points")
    for path, (door,) in entries(rows, ("doors",)):
        if not any(_is_within(walls, end) for end in (door.start, door.end)):
            yield Problem(f'the door "{door.name}" is outside the outer walls', *path, "from")


def _points(world: World, rows: Rows) -> Iterator[tuple[str, Path, Point]]:
    places = {(place.x, place.y) for place in world.places}
    for what, path, row in spots(rows):
        yield what, (*path, "x"), (row.x, row.y)
        for at, stop in enumerate(row.walks if isinstance(row, Person) else ()):
            if (stop.x, stop.y) not in places:  # of a place that is reported already
                yield f'a stop of "{row.name}"', (*path, "walks", at), (stop.x, stop.y)


def _is_within(walls: Sequence[Polyline], point: Point) -> bool:
    """Return whether a point is inside one of the walls, or on it."""
    return not is_outside(walls, point) or any(
        segment_distance(point, (*a, *b)) <= _TOUCHING for wall in walls for a, b in edges(wall)
    )


def _reaches_into(zone: Zone, wall: Polyline) -> bool:
    steps = [step / _STEPS for step in range(_STEPS)]
    points = ((ax + (bx - ax) * t, ay + (by - ay) * t) for (ax, ay), (bx, by) in edges(zone.points) for t in steps)
    return any(contains(wall, point) for point in points) or any(zone.contains(corner) for corner in wall)

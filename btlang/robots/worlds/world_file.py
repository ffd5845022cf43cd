"""Reads and checks world files (TOML). Imports neither numpy nor typing: `btc check` needs their names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from os import PathLike, fspath

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.files import DataFileError, as_mission_error, load_data, make_from
from btlang.robots.geometry import Point, Pose, Segment, segment_distance
from btlang.robots.worlds.world import AREA, NEVER, FurnitureBox, Place, World, WorldFault, WorldNames, Zone
from btlang.robots.worlds.world_bounds import entries, outside, spots
from btlang.robots.worlds.world_tables import (
    is_point,
    read_corners,
    read_crowd,
    read_door,
    read_lane,
    read_likeness,
    read_object,
    read_person,
    read_zone,
)
from btlang.text.source import Source
from btlang.text.time_of_day import USUAL_START
from btlang.text.toml_table import Problem, Problems, Table
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from btlang.robots.worlds.world_bounds import Rows

    T = TypeVar("T")

_MOST_CHECKS = 5_000_000  # of a place with a piece of wall, in some seconds
NAMED = ("places", "dock", "docks", "objects", "people", "zones", "doors", "crowds")
"""The keys of tables that have names."""
_SORTS = {"dock": "places", "docks": "places", "objects": "things", "people": "things", "crowds": "things"}
_FAULTS = ("blocked", "slip", "silent scanner", "weak hand", "dock")


class WorldError(DataFileError):
    """The reason why a world file can't be used."""

    code = "BT070"


def load_world(
    file: str | PathLike[str] | Source | None = None, body: Body | None = None, *, bounded: bool = False
) -> World:
    """Return the world in a file or a text, or the world that ships. Raises WorldError with everything that is wrong.

    It has to leave room for the body, by default that of the robot that ships. In a `bounded` world nothing may be
    outside the outer walls.
    """
    return _load(file, (body or standard_body()).radius, bounded=bounded)


def world_from(values: dict[str, Any], path: str, body: Body | None = None) -> World:
    """Return the world from the tables of a world file in another notation, such as JSON. Raises WorldError."""
    radius = (body or standard_body()).radius
    return make_from(values, path, "a world", lambda top: _world(top, radius), WorldError)


def world_names(file: str | PathLike[str] | Source | None = None) -> WorldNames:
    """Return the names in a file or a text, or in the world that ships. Raises WorldError.

    Which robot will need room there isn't known yet.
    """
    return _load(file, None, bounded=False).names


def _load(file: str | PathLike[str] | Source | None, radius: float | None, *, bounded: bool) -> World:
    given = DEFAULT_WORLD if file is None else file if isinstance(file, Source) else fspath(file)
    return load_data(given, "a world", lambda top: _world(top, radius, bounded), WorldError)


def _world(top: Table, radius: float | None, bounded: bool = False) -> World:
    """Make a world. Without a radius there may be any wall beside places, but none around them."""
    problems = Problems()
    begins: tuple[Pose | None, float] = (None, 100.0)
    start, battery = problems.part(lambda: _start(top), begins)
    walls: list[Any] = problems.part(lambda: top.items("walls"), [])
    pieces = [problems.part(partial(_wall, points, index), None) for index, points in enumerate(walls)]
    boxes = _made(problems.rows(top, "boxes", _box))
    with_areas = problems.rows(top, "places", _place)
    rows: dict[str, list[Any]] = {"start": [start], "places": [each and each[0] for each in with_areas]}
    dock = problems.part(lambda: _dock(top), None)
    rows["dock"], rows["docks"] = [dock], problems.rows(top, "docks", _further_dock)
    places = _made((*rows["places"], dock, *rows["docks"]))
    known = problems.part(lambda: top.flag("known", True), True)
    rows["objects"] = problems.rows(top, "objects", lambda table: read_object(table, known))
    rows["people"] = problems.rows(top, "people", lambda table: read_person(table, known, places))
    rows["crowds"] = problems.rows(top, "crowds", lambda table: read_crowd(table, known, places))
    rows["zones"], rows["doors"] = problems.rows(top, "zones", read_zone), problems.rows(top, "doors", read_door)
    names = tuple(place.name for place in places)
    docks = tuple(place.name for place in _made((dock, *rows["docks"])))
    faults = _made(problems.rows(top, "faults", lambda table: _fault(table, names, docks)))
    clock, weekday = problems.part(lambda: _clock(top) if top.has("clock") else (USUAL_START, 0), (USUAL_START, 0))
    seed = problems.part(lambda: int(top.number("seed", low=0.0)) if top.has("seed") else None, None)
    ordinals = problems.part(lambda: top.choice("ordinals", ("way", "name"), "way"), "way")
    home = problems.part(lambda: top.choice("home", names, ""), "")
    lanes = _made(problems.rows(top, "lanes", read_lane))
    problems.part(lambda: top.finish(None), None)
    objects, people, zones, doors = (_made(rows[key]) for key in ("objects", "people", "zones", "doors"))
    zones += tuple(each[1] for each in with_areas if each and each[1] is not None)
    people += tuple(person for crowd in _made(rows["crowds"]) for person in crowd)
    world = World(
        start or Pose(0.0, 0.0), battery, _made(pieces), boxes, places, objects, people, faults, dock, clock, zones,
        doors, seed, weekday, _made(rows["docks"]), ordinals, home,
        lanes,
    )  # fmt: skip
    problems.found += _names_given_twice(rows)
    problems.found += _without_room(world, rows, radius)
    if bounded:
        problems.found += outside(world, rows)
    problems.end()
    return world


def _made(rows: Iterable[T | None]) -> tuple[T, ...]:
    return tuple(row for row in rows if row is not None)


def _start(top: Table) -> tuple[Pose | None, float]:
    table = top.table("start")
    battery = table.number("battery", 100.0, low=0.0, high=100.0)
    return table.finish(Pose(table.number("x"), table.number("y"), table.number("facing", 0.0))), battery


def _dock(top: Table) -> Place | None:
    if not top.has("dock"):
        return None
    table = top.table("dock")
    return table.finish(Place("dock", table.number("x"), table.number("y"), table.number("facing", 0.0)))


def _further_dock(table: Table) -> Place:
    return table.finish(Place(table.text("name"), table.number("x"), table.number("y"), table.number("facing", 0.0)))


def _clock(top: Table) -> tuple[float, int]:
    from datetime import datetime  # most worlds begin at the usual time

    try:
        began = datetime.strptime(top.text("clock") if top.is_text("clock") else "", "%Y-%m-%d %H:%M")
    except ValueError:
        message = '"clock" must be a date and a time in quotes; write clock = "2026-03-02 08:55"'
        raise Problem(message, "clock") from None
    return began.hour * 3600.0 + began.minute * 60.0, began.weekday()


def _wall(points: Any, index: int) -> tuple[Point, ...]:
    if not isinstance(points, list) or len(points) < 2 or not all(map(is_point, points)):
        message = "a wall is a list of two or more points: write [[0, 0], [4, 0]]"
        raise Problem(message, "walls", index)
    return tuple((float(x), float(y)) for x, y in points)


def _box(table: Table) -> FurnitureBox:
    box = FurnitureBox(
        table.number("x"), table.number("y"), table.number("width", low=0.01), table.number("height", low=0.01)
    )
    return table.finish(box)


def _place(table: Table) -> tuple[Place, Zone | None]:
    """Read a place, and the zone that it is if the file has its corners."""
    facing = table.number("facing") if table.has("facing") else None
    kind = table.text("kind") if table.has("kind") else ""
    color, (sized, state, owner) = table.text("color") if table.has("color") else "", read_likeness(table)
    place = Place(table.text("name"), table.number("x"), table.number("y"), facing, kind, color, sized, state, owner)
    zone = Zone(place.name, AREA, read_corners(table)) if table.has("points") else None
    return table.finish((place, zone))


def _fault(table: Table, places: tuple[str, ...], docks: tuple[str, ...]) -> WorldFault:
    kind = table.choice("kind", _FAULTS)
    start, end = table.number("from", 0.0, low=0.0), table.number("until", NEVER, low=0.0)
    more: Mapping[str, Any] = {}
    if kind == "blocked":
        more = {"place": table.choice("place", places)}
    elif kind == "slip":
        wheel = table.choice("wheel", ("left", "right", "both"), "both")
        more = {"wheel": wheel, "grip": table.number("grip", low=0.0, high=1.0)}
    elif kind == "weak hand":
        hand = table.choice("hand", ("left", "right"), "right")
        more = {"hand": hand, "seconds": table.number("seconds", low=0.0)}
    elif kind == "dock":
        more = {"times": table.number("times", NEVER, low=1.0), "place": table.choice("place", docks, "")}
    return table.finish(WorldFault(kind, start, end, **more))


def _names_given_twice(rows: Rows) -> Iterator[Problem]:
    """Report names that are given twice. Several kinds may share one: a place and an area may both be "kitchen"."""
    seen: dict[tuple[str, str], str] = {}
    for (section, *index), group in entries(rows, NAMED):
        for named in group:
            key = _SORTS.get(str(section), str(section)), named.name.lower()
            if key in seen:
                message = f'the name "{named.name}" is given twice ({seen[key]} and {section}); give one another name'
                yield Problem(message, section, *index, "name")
            seen[key] = str(section)


def _without_room(world: World, rows: Rows, radius: float | None) -> Iterator[Problem]:
    standing = list(spots(rows, ("start", "places", "dock", "docks")))
    segments = world.segments()
    if len(standing) * len(segments) > _MOST_CHECKS:
        message = f"{len(standing):,} places are too many for {len(segments):,} pieces of wall; leave some out"
        yield Problem(message, "places")
        return
    for what, path, spot in standing:
        if not has_room(world, (spot.x, spot.y), radius or 0.0, segments):
            room = f"; leave {radius:g} m to every wall" if radius else ""
            yield Problem(f"{what} at ({spot.x:g}, {spot.y:g}) is inside a wall or a box{room}", *path, "x")


def has_room(world: World, point: Point, radius: float, segments: Iterable[Segment]) -> bool:
    """Return whether a point is that far from all segments of the world, and in no box."""
    inside = any(box.contains(point) for box in world.boxes)
    return not inside and min((segment_distance(point, segment) for segment in segments), default=NEVER) >= radius


def read_world(world: str | Source | None = None, body: Body | None = None, *, bounded: bool = False) -> World:
    """Return the world in a file or a text, by default the world that ships; as `load_world`.

    Raises MissionError (BT070).
    """
    try:
        return load_world(world, body, bounded=bounded)
    except WorldError as error:
        raise as_mission_error(error) from None

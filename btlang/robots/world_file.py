"""Reads and checks world files (TOML). Imports neither numpy nor typing: `btc check` asks it for names."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike, fspath

from btlang.robots.body_file import standard_body
from btlang.robots.data_file import DataFileError, load_data
from btlang.robots.geometry import Point, Pose, segment_distance
from btlang.robots.world import (
    NEVER,
    Box,
    Fault,
    Place,
    World,
    WorldNames,
)
from btlang.robots.world_tables import is_point, read_door, read_object, read_person, read_zone
from btlang.text.source import Source
from btlang.text.time_of_day import USUAL_START
from btlang.text.toml_table import Problem, Table
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.body import Body

_MOST_CHECKS = 5_000_000  # of a place with a piece of wall, in some seconds
_FAULTS = ("blocked", "slip", "silent scanner", "weak hand", "dock")


class WorldError(DataFileError):
    """A world file that cannot be used."""

    code = "BT070"


def load_world(file: str | PathLike[str] | Source | None = None, body: Body | None = None) -> World:
    """The world in a file or a text, or the world that ships. Raises WorldError.

    It has to leave room for the body, by default that of the robot that ships.
    """
    given = DEFAULT_WORLD if file is None else file if isinstance(file, Source) else fspath(file)
    radius = (body or standard_body()).radius
    return load_data(given, "a world", lambda top: _world(top, radius), WorldError)


def world_names(file: str | PathLike[str] | Source | None = None) -> WorldNames:
    """Places, objects and people of the world in a file or a text, or of the one that ships. Raises WorldError."""
    return load_world(file).names


def _world(top: Table, radius: float) -> World:
    table = top.table("start")
    battery = table.number("battery", 100.0, low=0.0, high=100.0)
    start = table.finish(Pose(table.number("x"), table.number("y"), table.number("facing", 0.0)))
    walls = tuple(_wall(points, index) for index, points in enumerate(top.items("walls")))
    boxes = tuple(map(_box, top.tables("boxes")))
    places = tuple(map(_place, top.tables("places")))
    dock = None
    if top.has("dock"):
        table = top.table("dock")
        dock = table.finish(Place("dock", table.number("x"), table.number("y"), table.number("facing", 0.0)))
        places += (dock,)
    known = top.flag("known", True)
    objects = tuple(read_object(table, known) for table in top.tables("objects"))
    people = tuple(read_person(table, known, places) for table in top.tables("people"))
    zones, doors = tuple(map(read_zone, top.tables("zones"))), tuple(map(read_door, top.tables("doors")))
    names = tuple(place.name for place in places)
    faults = tuple(_fault(table, names) for table in top.tables("faults"))
    clock = _clock(top) if top.has("clock") else USUAL_START
    seed = int(top.number("seed", low=0.0)) if top.has("seed") else None
    world = top.finish(
        World(start, battery, walls, boxes, places, objects, people, faults, dock, clock, zones, doors, seed)
    )
    _check_names(world)
    _check_room(world, radius)
    return world


def _clock(top: Table) -> float:
    from datetime import datetime  # most worlds begin at the usual time

    try:
        began = datetime.strptime(top.text("clock") if top.is_text("clock") else "", "%Y-%m-%d %H:%M")
    except ValueError:
        message = '"clock" must be a date and a time in quotes; write clock = "2026-03-02 08:55"'
        raise Problem(message, "clock") from None
    return began.hour * 3600.0 + began.minute * 60.0


def _wall(points: Any, index: int) -> tuple[Point, ...]:
    if not isinstance(points, list) or len(points) < 2 or not all(map(is_point, points)):
        message = "a wall is a list of two or more points: write [[0, 0], [4, 0]]"
        raise Problem(message, "walls", index)
    return tuple((float(x), float(y)) for x, y in points)


def _box(table: Table) -> Box:
    box = Box(table.number("x"), table.number("y"), table.number("width", low=0.01), table.number("height", low=0.01))
    return table.finish(box)


def _place(table: Table) -> Place:
    facing = table.number("facing") if table.has("facing") else None
    return table.finish(Place(table.text("name"), table.number("x"), table.number("y"), facing))


def _fault(table: Table, places: tuple[str, ...]) -> Fault:
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
        more = {"times": table.number("times", NEVER, low=1.0)}
    return table.finish(Fault(kind, start, end, **more))


def _check_names(world: World) -> None:
    seen: dict[str, str] = {}
    names = world.names
    for section, group in (
        ("places", names.places), ("objects", names.objects), ("people", names.people), ("zones", names.zones),
        ("doors", names.doors),
    ):  # fmt: skip
        for index, name in enumerate(group):
            key = name.lower()
            if key in seen:
                message = f'the name "{name}" is given twice ({seen[key]} and {section}); give one another name'
                raise Problem(message, section, index, "name")
            seen[key] = section


def _check_room(world: World, radius: float) -> None:
    spots: list[tuple[str, tuple[str | int, ...], float, float]] = [
        ("the start", ("start",), world.start.x, world.start.y)
    ]
    for index, place in enumerate(world.places):
        path: tuple[str | int, ...] = ("dock",) if place is world.dock else ("places", index)
        spots.append((f'the place "{place.name}"', path, place.x, place.y))
    segments = world.segments()
    if len(spots) * len(segments) > _MOST_CHECKS:
        message = f"{len(spots):,} places are too many for {len(segments):,} pieces of wall; leave some out"
        raise Problem(message, "places")
    for what, path, x, y in spots:
        inside = any(box.contains((x, y)) for box in world.boxes)
        gap = min((segment_distance((x, y), segment) for segment in segments), default=NEVER)
        if inside or gap < radius:
            message = f"{what} at ({x:g}, {y:g}) is inside a wall or a box; leave {radius:g} m to every wall"
            raise Problem(message, *path, "x")

"""Reads and checks world files (TOML). Imports neither numpy nor typing: `btc check` asks it for names."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from os import PathLike, fspath

from btlang.diagnostics.reading import read_bytes
from btlang.robots import world_lines
from btlang.robots.geometry import Point, Pose, segment_distance
from btlang.robots.world import (
    NEVER,
    OBJECT_RADIUS,
    PERSON_RADIUS,
    ROBOT_RADIUS,
    Box,
    Fault,
    Place,
    Thing,
    World,
    WorldNames,
)
from btlang.robots.world_table import Problem, Table
from btlang.text.toml import parse_toml
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_FAULTS = ("blocked", "slip", "silent scanner", "weak hand")


class WorldError(Exception):
    """A world file that cannot be used: `message` says what to write instead; `line` counts from 1, None if unknown."""

    def __init__(self, message: str, path: str, line: int | None = None) -> None:
        super().__init__(f"{path}:{line}: {message}" if line else f"{path}: {message}")
        self.message = message
        self.path = path
        self.line = line


def load_world(path: str | PathLike[str] | None = None) -> World:
    """The world in the file, or the world that ships. Raises WorldError."""
    name = DEFAULT_WORLD if path is None else fspath(path)
    try:
        text = _read(name)
    except OSError as error:
        raise WorldError(f"cannot read the world file: {error.strerror or error}", name) from None
    except UnicodeDecodeError:
        raise WorldError("a world file is UTF-8 text; save it as such", name) from None
    try:
        return _world(Table("", parse_toml(text)))
    except tomllib.TOMLDecodeError as error:
        raise WorldError(f"this is no TOML: {error}", name, world_lines.line_in_message(str(error))) from None
    except Problem as problem:
        line = world_lines.find_line(text, problem.section, problem.index, problem.key)
        raise WorldError(problem.message, name, line) from None


def world_names(path: str | PathLike[str] | None = None) -> WorldNames:
    """Places, objects and people of the world in the file, or of the one that ships. Raises WorldError."""
    return load_world(path).names


def _read(name: str) -> str:
    read = getattr(__spec__.loader, "get_data", None)  # reads the packaged world from a zipped wheel too
    if name == DEFAULT_WORLD and read is not None:
        data: bytes = read(name)
        return data.decode("utf-8-sig")
    return read_bytes(name).decode("utf-8-sig")


def _world(top: Table) -> World:
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
    objects = tuple(_thing(table, OBJECT_RADIUS) for table in top.tables("objects"))
    people = tuple(_thing(table, PERSON_RADIUS) for table in top.tables("people"))
    faults = tuple(_fault(table, [place.name for place in places]) for table in top.tables("faults"))
    world = top.finish(World(start, battery, walls, boxes, places, objects, people, faults, dock))
    _check_names(world)
    _check_room(world)
    return world


def _wall(points: Any, index: int) -> tuple[Point, ...]:
    if not isinstance(points, list) or len(points) < 2 or not all(map(_is_point, points)):
        message = "a wall is a list of two or more points: write [[0, 0], [4, 0]]"
        raise Problem(message, "walls", index)
    return tuple((float(x), float(y)) for x, y in points)


def _is_point(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(type(number) in (int, float) for number in value)


def _box(table: Table) -> Box:
    box = Box(table.number("x"), table.number("y"), table.number("width", low=0.01), table.number("height", low=0.01))
    return table.finish(box)


def _place(table: Table) -> Place:
    facing = table.number("facing") if table.has("facing") else None
    return table.finish(Place(table.text("name"), table.number("x"), table.number("y"), facing))


def _thing(table: Table, radius: float) -> Thing:
    thing = Thing(table.text("name"), table.number("x"), table.number("y"), table.number("radius", radius, low=0.01))
    return table.finish(thing)


def _fault(table: Table, places: list[str]) -> Fault:
    kind = table.choice("kind", _FAULTS)
    start, end = table.number("from", 0.0, low=0.0), table.number("until", NEVER, low=0.0)
    more: Mapping[str, Any] = {}
    if kind == "blocked":
        more = {"place": table.choice("place", tuple(places))}
    elif kind == "slip":
        wheel = table.choice("wheel", ("left", "right", "both"), "both")
        more = {"wheel": wheel, "grip": table.number("grip", low=0.0, high=1.0)}
    elif kind == "weak hand":
        hand = table.choice("hand", ("left", "right"), "right")
        more = {"hand": hand, "seconds": table.number("seconds", low=0.0)}
    return table.finish(Fault(kind, start, end, **more))


def _check_names(world: World) -> None:
    seen: dict[str, str] = {}
    names = world.names
    for section, group in (("places", names.places), ("objects", names.objects), ("people", names.people)):
        for index, name in enumerate(group):
            key = name.lower()
            if key in seen:
                message = f'the name "{name}" is given twice ({seen[key]} and {section}); give one another name'
                raise Problem(message, section, index, "name")
            seen[key] = section


def _check_room(world: World) -> None:
    spots: list[tuple[str, str, int, float, float]] = [("the start", "start", 0, world.start.x, world.start.y)]
    for index, place in enumerate(world.places):
        section = "dock" if place is world.dock else "places"
        spots.append((f'the place "{place.name}"', section, index, place.x, place.y))
    for what, section, index, x, y in spots:
        inside = any(box.contains((x, y)) for box in world.boxes)
        gap = min((segment_distance((x, y), segment) for segment in world.segments()), default=NEVER)
        if inside or gap < ROBOT_RADIUS:
            message = f"{what} at ({x:g}, {y:g}) is inside a wall or a box; leave {ROBOT_RADIUS} m to every wall"
            raise Problem(message, section, index, "x")

"""A world from files of other programs: the walls of maps, the places of way points, and worlds in JSON or YAML."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from math import cos, pi, sin

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import read_source
from btlang.maps.building import Building, is_building, read_building
from btlang.maps.data_text import ForeignFileError, is_world, read_data, read_world_data
from btlang.maps.occupancy import OccupancyMap, is_map, read_map, walls_of
from btlang.maps.reach import reached
from btlang.maps.way_points import WayPoints, way_points
from btlang.robots.files import as_mission_error
from btlang.robots.geometry import Point, Pose, Segment
from btlang.robots.worlds.world import Door, Lane, Place, World
from btlang.robots.worlds.world_bounds import closed_walls, is_outside
from btlang.robots.worlds.world_file import WorldError, has_room
from btlang.support.record import Record
from btlang.text.source import NOWHERE
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

_FARTHEST, _STEP = 0.5, 0.05  # metres that a place without room is moved at most
_MOST_SHOWN = 10  # way points of a file
_MOST_CHECKS = 5_000_000  # of a place with a piece of wall: as many as a world file may take


_Part: TypeAlias = "World | WayPoints | OccupancyMap | Building"


class ImportedWorld(Record):
    """A world from files of other programs.

    `found` are lines that show what was read from the files, `warnings` those about places that were moved, renamed or
    left out and other things to look at.
    """

    world: World
    found: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def import_world(
    paths: Sequence[str],
    radius: float,
    start: Pose | None = None,
    origin: Point | None = None,
    level: str | None = None,
) -> ImportedWorld:
    """Return the world of all files together.

    It starts at `start`, by default at the first way point, and leaves room for a robot of that radius. Way points in
    degrees need the latitude and longitude of the `origin`, and buildings with several levels the name of one. Raises
    MissionError with what is wrong in all files.
    """
    parts, problems = list[_Part](), []
    for path in paths:
        try:
            parts.append(_read(path, origin, level))
        except MissionError as error:
            problems += error.diagnostics
    if problems:
        raise MissionError(problems)
    read = list(zip(paths, parts, strict=True))
    found = [line for path, part in read for line in _show(path, part)]
    notes = [f"{path}: {note}" for path, part in read if isinstance(part, WayPoints) for note in part.notes]
    world, warnings = _together(parts, radius, start)
    return ImportedWorld(world, tuple(found), (*notes, *warnings))


def _show(path: str, part: _Part) -> Iterator[str]:
    """Yield lines that show what a file was understood as."""
    if isinstance(part, OccupancyMap):
        rows, columns = part.free.shape
        yield f"{path}: a map of {columns * part.resolution:g} m x {rows * part.resolution:g} m"
    elif not isinstance(part, World):
        lanes = f" and {_count(part.lanes, 'lane')}" if part.lanes else ""
        if isinstance(part, Building):
            yield f"{path}: the level {part.level} of a building, with {_count(part.places, 'place')}{lanes}"
        else:
            yield f"{path}: {_count(part.places, 'way point')}{lanes}"
        for place in part.places[:_MOST_SHOWN]:
            facing = "" if place.facing is None else f", facing {place.facing:.4g} degrees"
            yield f"  {place.name}: ({place.x:g}, {place.y:g}){facing}"
        if len(part.places) > _MOST_SHOWN:
            yield f"  ... and {len(part.places) - _MOST_SHOWN:,} more"


def _count(things: Sequence[object], name: str) -> str:
    return f"{len(things):,} {name}{'s' if len(things) != 1 else ''}"


def _read(path: str, origin: Point | None, level: str | None) -> _Part:
    """Read a file: a world, a building, way points, or a map."""
    source = read_source(path)
    try:
        data = read_data(source)
        if is_map(data):
            return read_map(data, os.path.dirname(path) or os.curdir)
        if is_world(data):
            return read_world_data(data, path)
        if is_building(data):
            return read_building(data, level)
        return way_points(data, origin)
    except (ForeignFileError, WorldError) as error:
        raise as_mission_error(error) from None
    except RecursionError:
        raise as_mission_error(ForeignFileError("it is nested too deep", path, None, source)) from None
    except Problem as problem:
        raise as_mission_error(ForeignFileError(problem.message, path, None, source)) from None


def _together(parts: Iterable[_Part], radius: float, start: Pose | None) -> tuple[World, list[str]]:
    whole: World | None = None
    maps: list[OccupancyMap] = []
    places: list[Place] = []
    doors: list[Door] = []
    chargers: set[str] = set()
    walls: list[tuple[Point, ...]] = []
    lanes: list[Lane] = []
    for part in parts:
        if isinstance(part, World) and whole is not None:
            raise _unusable("only one of the files may be a whole world")
        if isinstance(part, World):
            whole = part
        elif isinstance(part, WayPoints):
            places += part.places
            lanes += part.lanes
        elif isinstance(part, Building):
            walls += part.walls
            doors += part.doors
            places += part.places
            lanes += part.lanes
            chargers |= part.chargers
            start = start or part.start
        else:
            maps.append(part)
    notes: list[str] = []
    if start is None and whole is None:
        if not places and not maps:
            raise _unusable("there is no start: give it with --start X,Y, or add a list of way points")
        start = Pose(places[0].x, places[0].y, places[0].facing or 0.0) if places else _guess_start(maps[0], radius)
        if not places:
            notes.append(f"the files have no start, so the robot starts at ({start.x:g}, {start.y:g})")
    base = whole or World(start or Pose(0.0, 0.0))
    start = start or base.start
    for each in maps:
        around, apart = _walls(each, (start.x, start.y), places, radius)
        walls += around
        notes += apart
    base = base.replace(
        start=start, walls=(*base.walls, *walls), doors=(*base.doors, *doors), lanes=(*base.lanes, *lanes)
    )
    world, changes = _with_room(base, _without_doubles(places), radius)
    at_chargers = [place for place in world.places if place.name in chargers and place != world.dock]
    others = tuple(place for place in world.places if place not in at_chargers)
    docks = tuple(place.replace(facing=place.facing or 0.0) for place in at_chargers)
    return world.replace(places=(*others, *docks), docks=(*world.docks, *docks)), notes + changes


def _without_doubles(places: Iterable[Place]) -> list[Place]:
    """Return the places, without those that another file has by the same name and at the same spot."""
    found: dict[tuple[str, float, float], Place] = {}
    for place in places:
        key = place.name.lower(), round(place.x, 2), round(place.y, 2)
        first = found.setdefault(key, place)
        if first.facing is None and place.facing is not None:
            found[key] = first.replace(facing=place.facing)
    return list(found.values())


def _guess_start(occupancy: OccupancyMap, radius: float) -> Pose:
    spot = occupancy.spot_with_room(radius)
    if spot is None:
        raise _unusable("the map has no free floor where the robot has room")
    return Pose(*spot)


def _walls(
    occupancy: OccupancyMap, start: Point, places: Iterable[Place], radius: float
) -> tuple[tuple[tuple[Point, ...], ...], list[str]]:
    """Return the walls around what can be reached from the start and from places, and a line for each place that can't
    be reached from the start.
    """
    seed = occupancy.free_near(start, _FARTHEST)
    if seed is None:
        spot = occupancy.spot_with_room(radius)
        advice = f"; give one with --start X,Y, such as --start={spot[0]:g},{spot[1]:g}" if spot is not None else ""
        raise _unusable(f"the start at ({start[0]:g}, {start[1]:g}) isn't on free floor of the map{advice}")
    try:
        free = reached(occupancy.free, [seed])
        seeds = [(place, occupancy.free_near((place.x, place.y), _FARTHEST)) for place in places]
        apart = [(place, cell) for place, cell in seeds if cell is not None and not free[cell[::-1]]]
        free |= reached(occupancy.free, [cell for _, cell in apart])
        walls = walls_of(occupancy, free, 2 * radius)
    except Problem as problem:
        raise _unusable(problem.message) from None
    return walls, [f'on the map there is no way from the start to the place "{place.name}"' for place, _ in apart]


def _unusable(reason: str) -> MissionError:
    return MissionError([diagnostic(ForeignFileError.code, NOWHERE, reason=reason)])


def _with_room(world: World, more: Sequence[Place], radius: float) -> tuple[World, list[str]]:
    """Return the world with places and a start where the robot has room, with a line for each change."""
    segments, notes = world.segments(), list[str]()
    if len(segments) * (len(more) + len(world.places) + 1) > _MOST_CHECKS:
        raise _unusable(f"{len(segments):,} pieces of wall are too many for {len(more):,} way points")
    start = world.start
    moved = _room_near(world, (start.x, start.y), radius, segments)
    if moved is None:
        raise _unusable(f"the start at ({start.x:g}, {start.y:g}) is too near to a wall; give one with --start X,Y")
    if moved != (start.x, start.y):
        notes.append(_describe_change("the start", (start.x, start.y), moved))
    known = {name.lower(): 1 for names in world.names.by_type.values() for name in names}
    added: list[Place] = []
    for place in more:
        at = (place.x, place.y)
        spot = _room_near(world, at, radius, segments)
        if spot is None or spot != at:
            notes.append(_describe_change(f'the place "{place.name}"', at, spot))
        if spot is not None:
            name = _free(place.name, known)
            if name != place.name:
                notes.append(f'the name "{place.name}" is given twice; the second is called "{name}"')
            added.append(place.replace(name=name, x=spot[0], y=spot[1]))
    walls = closed_walls(world)
    beyond = (place for place in added if is_outside(walls, (place.x, place.y)))
    notes += [f'the place "{place.name}" is outside the outer walls' for place in beyond]
    dock = world.dock or next((place for place in added if place.name.lower() == "dock"), None)
    if dock is not None and dock in added:
        added.remove(dock)
        dock = Place("dock", dock.x, dock.y, dock.facing or 0.0)
        added.append(dock)
    return world.replace(start=Pose(*moved, start.heading), places=(*world.places, *added), dock=dock), notes


def _free(name: str, known: dict[str, int]) -> str:
    """Return the name, or the first of "name 2", "name 3" ... that isn't known, and make it known; `known` has the last
    number.
    """
    free = name
    while free.lower() in known:
        known[name.lower()] += 1
        free = f"{name} {known[name.lower()]}"
    known[free.lower()] = 1
    return free


def _room_near(world: World, point: Point, radius: float, segments: Sequence[Segment]) -> Point | None:
    """Return the nearest point with room for the robot, at most half a metre away; None if there isn't any."""
    if has_room(world, point, radius, segments):
        return point
    x, y = point
    reach = radius + _FARTHEST
    near = [each for each in segments if _touches(each, (x - reach, y - reach, x + reach, y + reach))]
    for ring in range(1, round(_FARTHEST / _STEP) + 1):
        count = 8 * ring
        angles = (2 * pi * step / count for step in range(count))
        spots = ((round(x + ring * _STEP * cos(a), 3), round(y + ring * _STEP * sin(a), 3)) for a in angles)
        found = next((spot for spot in spots if has_room(world, spot, radius, near)), None)
        if found is not None:
            return found
    return None


def _touches(segment: Segment, area: tuple[float, float, float, float]) -> bool:
    """Return whether the rectangle around a segment overlaps one."""
    ax, ay, bx, by = segment
    left, low, right, high = area
    return min(ax, bx) <= right and max(ax, bx) >= left and min(ay, by) <= high and max(ay, by) >= low


def _describe_change(what: str, at: Point, to: Point | None) -> str:
    x, y = at
    done = "is left out" if to is None else f"is moved to ({to[0]:g}, {to[1]:g})"
    return f"{what} at ({x:g}, {y:g}) is too near to a wall, so it {done}"

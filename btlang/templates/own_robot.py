"""The files of a project for a robot that exists: from its URDF, its map and its way points."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.maps.importing import import_world
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import BodyError, load_body, standard_body
from btlang.robots.bodies.urdf_reader import read_urdf
from btlang.robots.files import as_mission_error
from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import RobotError
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.planning import PathPlanner
from btlang.robots.worlds.world import Place, World
from btlang.robots.worlds.world_writing import to_toml
from btlang.support.record import Record
from btlang.text.source import Source

_MOST_STOPS, _MOST_PLANNED = 3, 12  # of the mission; places to which a way is looked for
_WORLD = "world.toml"
_TESTS = """# btc test, in this folder
test "it does its round":
  run "patrol.txt"
  finally the mission succeeds
"""


class OwnRobot(Record):
    """The texts of files by their names, what was read from the files of the robot, and what a user should check."""

    files: dict[str, str]
    found: tuple[str, ...]
    checks: tuple[str, ...]


def own_robot(
    name: str,
    urdf: str | None,
    worlds: Sequence[str],
    template: str,
    start: Pose | None = None,
    origin: Point | None = None,
) -> OwnRobot:
    """Make the robot file from a URDF file, or from the template, and the world from maps and way points.

    The mission goes to places to which the robot finds a way. Raises MissionError.
    """
    text, checks = (template, []) if urdf is None else _robot(urdf)
    try:
        body = load_body(Source(text.replace(f'world = "{_WORLD}"\n', ""), "robot.toml"))
    except BodyError as problem:
        raise as_mission_error(problem) from None
    files = {"robot.toml": text}
    found: tuple[str, ...] = ()
    if worlds:
        radius = max(body.radius, standard_body().radius)  # tests in English run on the standard robot
        imported = import_world(worlds, radius, start, origin)
        found, checks = imported.found, [*checks, *imported.warnings]
        world = imported.world
    else:
        world = World(Pose(0.0, 0.0))
        checks.append("the world has no walls and no places: add a map with --map, and places with --waypoints")
    files[_WORLD] = to_toml(world).encode(errors="replace").decode()
    stops = _stops(world, body, checks) if body.navigation else []
    if body.base is None:
        checks.append("no wheels were found, so it can't drive: add a [base] to robot.toml if it can")
    files["patrol.txt"] = _mission(name, stops)
    files["patrol.test.txt"] = _TESTS
    return OwnRobot(files, found, tuple(checks))


def _robot(path: str) -> tuple[str, list[str]]:
    try:
        skeleton = read_urdf(read_source(path))
    except BodyError as problem:
        raise as_mission_error(problem) from None
    return skeleton.toml([f'world = "{_WORLD}"', "screen = true"]), list(skeleton.notes)


def _stops(world: World, body: Body, checks: list[str]) -> list[str]:
    """Return the names of a few places that missions can say and to which there is a way for this robot."""
    try:
        planner = PathPlanner(world, Obstacles(world), max(body.radius, standard_body().radius))
    except RobotError as problem:
        checks.append(str(problem))
        return []
    at, stops = (world.start.x, world.start.y), list[str]()
    for place in list(_sayable(world.places))[:_MOST_PLANNED]:
        if len(stops) == _MOST_STOPS:
            break
        if planner.path(at, (place.x, place.y)) is None:
            checks.append(f'the robot finds no way to the place "{place.name}"')
        else:
            stops.append(place.name)
            at = (place.x, place.y)
    return stops


def _sayable(places: Iterable[Place]) -> Iterator[Place]:
    for place in places:
        known = Source(to_toml(World(Pose(0.0, 0.0), places=(place,))), _WORLD)
        try:
            parse_tree(f"go to the {place.name}", world=known)
        except MissionError:
            continue
        yield place


def _mission(name: str, stops: Sequence[str]) -> str:
    lines = [f"# A first mission of {name}:", "#   btc run patrol.txt --robot robot.toml", f'world "{_WORLD}"', ""]
    going = ", then ".join(f"go to the {stop}" for stop in stops)
    return "\n".join([*lines, *([going] if going else []), 'print "All is well"', ""])

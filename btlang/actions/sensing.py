"""Conditions: what the robot senses. All are instantaneous; where the scanner is silent there may be a wall."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import dist, inf, radians
from weakref import ref

from btlang.actions.common import compares, of_a_kind, where
from btlang.engine.leaves.leaf import Failed
from btlang.robots.geometry import Point
from btlang.robots.robot import Base, Docking, Hands, Navigation, Power, RobotError, Sensors, SensorSilent

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from btlang.robots.bodies.body import Body
    from btlang.robots.worlds.scan import Array

    Found = TypeVar("Found")

NEAR_WALL = 0.6
"""Metres before the robot: after "no wall in front" it can drive 0.5 m."""
NEAR_PERSON = 1.5
AT_PLACE = 0.5
LOW_BATTERY = 20.0
SUFFICIENT_BATTERY = 30.0
FULL_BATTERY = 99.5

_SIDE_MARGIN = 0.03
_found: dict[int, tuple[ref[Array], dict[Any, Any]]] = {}
"""What was found in scans that still exist, by their ids: a robot gives the same one to all until it has another."""
_SIDES = {0.0: "ahead", 90.0: "to the left", 180.0: "behind", 270.0: "to the right"}


def wall_in_front(robot: Sensors) -> bool:
    """Return whether the next 0.5 m ahead (plus the robot's own length, and a margin) aren't
    free of walls and things.
    """
    return is_blocked(robot, 0.0)


def wall_on_left(robot: Sensors) -> bool:
    """Return whether a robot turned left would have a wall in front."""
    return is_blocked(robot, 90.0)


def wall_on_right(robot: Sensors) -> bool:
    """Return whether a robot turned right would have a wall in front."""
    return is_blocked(robot, -90.0)


def wall_behind(robot: Sensors) -> bool:
    """Return whether a robot turned around would have a wall in front."""
    return is_blocked(robot, 180.0)


def path_is_clear(robot: Sensors) -> bool:
    """Return the opposite of `wall_in_front`."""
    return not wall_in_front(robot)


def is_blocked(robot: Sensors, direction: float) -> bool:
    """Return whether a scan point lies in the strip that the robot would sweep in a direction (degrees left of ahead).

    The strip is as wide as the robot and a margin, and NEAR_WALL metres beyond its rim: after False, 0.5 m in that
    direction can't bump. What the scanner doesn't see counts as blocked, since no valid beam looks there.
    """
    try:
        return _from_scan(robot, _find_blocked, direction)
    except RobotError:
        return True  # a failed condition would read as "no wall" under `not` and `until`, and the robot drive blind


def distance_ahead(robot: Sensors) -> float:
    """Return the metres that the robot can drive straight ahead before it touches something.

    inf beyond the scanner's range. Raises SensorSilent if the scanner doesn't look there.
    """
    return _from_scan(robot, _find_free, 0.0)


def _find_blocked(scan: Array, body: Body, direction: float) -> bool:
    along, across = _points(scan, body, direction)
    strip = (along > 0.0) & (along < body.radius + NEAR_WALL) & (abs(across) < body.radius + _SIDE_MARGIN)
    return bool(strip.any())


def _find_free(scan: Array, body: Body, direction: float) -> float:
    along, across = _points(scan, body, direction)
    touching = (along > 0.0) & (abs(across) < body.radius)
    bulge = (body.radius**2 - across[touching] ** 2) ** 0.5
    return max(0.0, float((along[touching] - bulge).min(initial=inf)))


def _from_scan(robot: Sensors, find: Callable[[Array, Body, float], Found], direction: float) -> Found:
    """Return what is found in the present scan, once for all who ask before the next one: a robot gives the same array
    until then, and whoever may write into an array isn't asked twice.
    """
    scan = robot.scan()
    kept = _found.get(id(scan))
    if kept is None or kept[0]() is not scan:
        if getattr(getattr(scan, "flags", None), "writeable", True):
            return find(scan, robot.body, direction)
        kept = ref(scan, partial(_forget, id(scan))), {}
        _found[id(scan)] = kept
    results = kept[1]
    if (find, direction) not in results:
        results[find, direction] = find(scan, robot.body, direction)
    return results[find, direction]  # type: ignore[no-any-return]


def _forget(key: int, _: object) -> None:
    _found.pop(key, None)


def _points(scan: Array, body: Body, direction: float) -> tuple[Array, Array]:
    """Return scan points in metres along and across a direction. Raises SensorSilent if no valid beam looks there."""
    import numpy as np  # takes longer to import than many missions that sense something else

    from btlang.robots.motion.guard.corridor import is_covered

    ranges, scanner = np.asarray(scan), body.sensor("scanner")
    if not is_covered(ranges, direction, scanner.view if scanner is not None and direction == scanner.angle else 360.0):
        raise SensorSilent(f"the scanner has no valid beam {_SIDES.get(direction % 360.0, 'there')}")
    seen = np.isfinite(ranges)
    angles = np.radians(np.flatnonzero(seen)) - radians(direction)
    return ranges[seen] * np.cos(angles), ranges[seen] * np.sin(angles)


def bumped(robot: Sensors) -> bool:
    """Return whether the robot has run into something and not moved away since."""
    return robot.bumped


def stuck(robot: Base) -> bool:
    """Return whether the robot is commanded to move and does not."""
    return robot.stuck


def battery_level(robot: Power) -> float:
    """Return the percentage that is left."""
    return robot.battery


def battery_low(robot: Power) -> bool:
    """Return whether less than 20% is left."""
    return robot.battery < LOW_BATTERY


def battery_sufficient(robot: Power) -> bool:
    """Return whether more than 30% is left."""
    return robot.battery > SUFFICIENT_BATTERY


def battery_full(robot: Power) -> bool:
    """Return whether the battery is charged."""
    return robot.battery >= FULL_BATTERY


def docked(robot: Docking) -> bool:
    """Return whether the robot is connected to its dock."""
    return robot.docked


def charging(robot: Power) -> bool:
    """Return whether the battery is being charged."""
    return robot.charging


def at_place(robot: Base, place: str | None = None, x: float | None = None, y: float | None = None) -> bool:
    """Return whether the robot is within half a metre of a place or a point."""
    return robot.pose.distance_to(where(robot, place, x, y)) <= AT_PLACE


def distance_to_place(robot: Base, place: str | None = None, x: float | None = None, y: float | None = None) -> float:
    """Return the metres to a place or a point in a straight line."""
    return robot.pose.distance_to(where(robot, place, x, y))


def distance_to_person(robot: Base, person: str) -> float:
    """Return the metres to a person in a straight line."""
    return robot.pose.distance_to(robot.locate(person))


def distance_to_object(robot: Base, object: str) -> float:
    """Return the metres to an object in a straight line."""
    return robot.pose.distance_to(robot.locate(object))


def place_of_person(robot: Navigation, person: str) -> str:
    """Return the name of the place nearest to a person."""
    return _place_of(robot, person)


def place_of_object(robot: Navigation, object: str) -> str:
    """Return the name of the place nearest to an object."""
    return _place_of(robot, object)


def place_of_robot(robot: Navigation) -> str:
    """Return the name of the place nearest to the robot."""
    return _nearest_place(robot, (robot.pose.x, robot.pose.y))


def _place_of(robot: Navigation, name: str) -> str:
    return _nearest_place(robot, robot.locate(name))


def _nearest_place(robot: Navigation, point: Point) -> str:
    return min(robot.place_names(), key=lambda place: dist(robot.locate(place), point))


def people_near(robot: Base) -> int:
    """Return how many people are within 1.5 m."""
    return len(robot.nearby_people(NEAR_PERSON))


def person_near(robot: Base, person: str) -> bool:
    """Return whether a person is within 1.5 m."""
    return robot.pose.distance_to(robot.locate(person)) <= NEAR_PERSON


def someone_near(robot: Base) -> bool:
    """Return whether anybody is within 1.5 m."""
    return bool(robot.nearby_people(NEAR_PERSON))


def someone_within(robot: Base, distance: float) -> bool:
    """Return whether anybody is at most so many metres away."""
    return bool(robot.nearby_people(distance))


def obstacle_within(robot: Sensors, distance: float) -> bool:
    """Return whether the robot can't drive so many metres straight ahead. Raises SensorSilent as
    `distance_ahead` does.
    """
    return distance_ahead(robot) < distance


def object_known(robot: Base, object: str) -> bool | Failed:
    """Return whether the robot knows where an object is."""
    try:
        robot.locate(object)
    except RobotError as problem:
        return Failed(str(problem))
    return True


def object_is_at(robot: Base, object: str, place: str) -> bool:
    """Return whether an object is at a place, as far as the robot knows."""
    return object in robot.described("object", {"named": object, "at": place})


def object_is_on(robot: Base, object: str, container: str) -> bool:
    """Return whether an object is on or in another one, as far as the robot knows."""
    return object in robot.described("object", {"named": object, "on": container})


def person_is_at(robot: Base, person: str, place: str) -> bool:
    """Return whether a person is at a place, as far as the robot knows."""
    return person in robot.described("person", {"named": person, "at": place})


def someone_near_place(robot: Base, place: str) -> bool:
    """Return whether anybody is near a place, as far as the robot knows."""
    return bool(robot.described("person", {"near": place}))


def person_near_place(robot: Base, person: str, place: str) -> bool:
    """Return whether a person is near a place, as far as the robot knows."""
    return person in robot.described("person", {"named": person, "near": place})


def object_near_place(robot: Base, object: str, place: str) -> bool:
    """Return whether an object is near a place, as far as the robot knows."""
    return object in robot.described("object", {"named": object, "near": place})


def someone_at_door(robot: Base, door: str) -> bool:
    """Return whether anybody is near a door, as far as the robot knows."""
    return bool(robot.described("person", {"near": door}))


def person_at_door(robot: Base, person: str, door: str) -> bool:
    """Return whether a person is near a door, as far as the robot knows."""
    return person in robot.described("person", {"named": person, "near": door})


def something_is_at(robot: Base, place: str) -> bool:
    """Return whether any object is at a place, as far as the robot knows."""
    return bool(robot.described("object", {"at": place}))


def someone_is_at(robot: Base, place: str) -> bool:
    """Return whether anybody is at a place, as far as the robot knows."""
    return bool(robot.described("person", {"at": place}))


def people_at(
    robot: Base,
    place: str,
    below: float | None = None,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    equal: float | None = None,
) -> bool | Failed:
    """Return whether so many people are at a place, as far as the robot knows."""
    found = len(robot.described("person", {"at": place}))
    return compares(found, below, above, at_least, at_most, equal) or Failed(lambda: f"it knows of {found} there")


def objects_at(
    robot: Base,
    kinds: str,
    place: str,
    below: float | None = None,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    equal: float | None = None,
) -> bool | Failed:
    """Return whether so many objects or people of a kind are at a place, as far as the robot knows."""
    found = len(of_a_kind(robot, kinds, at=place))
    return compares(found, below, above, at_least, at_most, equal) or Failed(lambda: f"it knows of {found} there")


def holding(robot: Hands, object: str) -> bool:
    """Return whether either hand holds the object."""
    return object in (robot.holding("left"), robot.holding("right"))


def holding_something(robot: Hands) -> bool:
    """Return whether either hand holds anything."""
    return robot.holding("left") is not None or robot.holding("right") is not None


def hand_empty(robot: Hands) -> bool:
    """Return whether neither hand holds anything."""
    return not holding_something(robot)

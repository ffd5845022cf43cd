"""Journeys to a name, to one side of something, or to a part of a region. A failure has the robot's reason."""

from __future__ import annotations

from collections.abc import Callable
from math import dist

from btlang.actions.common import MeetingRobot, keep_pace, speaker, where
from btlang.actions.motion import Steps
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point, Pose, centre_of
from btlang.robots.robot import Base, Navigation, Operation, RobotError
from btlang.robots.worlds.descriptions import describe_relations
from btlang.robots.worlds.likeness import unseen
from btlang.robots.worlds.world import said
from btlang.vocabulary.references import NEAREST, SOUGHT, Choice

PASSED = 0.5
"""Metres from a place within which the robot has passed it."""
_SPEAKING = "speaking"  # how the person is chosen who spoke last
_SPOTS = 12  # that are tried to get in or out of a zone
_BESIDE = 1.0
"""Metres from a thing at which a robot that goes to a side of it stops."""
_AHEAD = {"front": (-1.0, 0.0), "behind": (1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
"""The direction of each side: along the robot's line of sight, and to the left of it."""


def go_to(
    robot: Navigation,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    facing: float | None = None,
    manner: str | None = None,
    via: str | None = None,
) -> Steps:
    """Drive to a place and face as the place says, or to a point; past those of `via` (`hall; lobby`) first."""
    steps = travel(robot, place) if place is not None else _go_to_point(robot, x, y, facing)
    yield from keep_pace(
        robot, manner, _past(robot, [name.strip() for name in (via or "").split(";") if name.strip()], steps)
    )


def _past(robot: Navigation, places: list[str], steps: Steps) -> Steps:
    """Pass each of the places, or zones, without a stop, then take the steps."""
    for name in places:
        try:
            point = robot.locate(name)
        except RobotError:  # no place has the name
            yield from over_border(robot, name, inside=True)
            continue
        operation = robot.navigate_to(name)
        try:
            while not operation.done and robot.pose.distance_to(point) > PASSED:
                yield
            if operation.done and operation.failure is not None:
                raise ActionFailed(operation.failure)
        finally:
            operation.cancel()
    yield from steps


def over_border(robot: Navigation, zone: str, *, inside: bool) -> Steps:
    """Drive until the robot is inside a zone, or outside. Fails if no way leads there."""
    here = robot.pose.x, robot.pose.y
    if robot.zones.contains(zone, here) == inside:
        return
    failure = f"there's no room {'in' if inside else 'around'} {said(zone)}"
    for spot in robot.zones.spots(zone, here, inside)[:_SPOTS]:
        operation = robot.navigate_to_pose(Pose(*spot, robot.pose.heading + robot.pose.bearing_to(spot)), said(zone))
        try:
            while not operation.done:
                if robot.zones.is_over(zone, (robot.pose.x, robot.pose.y), inside):
                    return
                yield
        finally:
            operation.cancel()
        if operation.failure is None:
            return
        failure = operation.failure
    raise ActionFailed(failure)


def _go_to_point(robot: Navigation, x: float | None, y: float | None, facing: float | None) -> Steps:
    point = where(robot, None, x, y)
    heading = robot.pose.heading + robot.pose.bearing_to(point) if facing is None else facing
    yield from accomplish(robot.navigate_to_pose(Pose(*point, heading)))


def go_to_person(robot: Navigation, person: str, manner: str | None = None) -> Steps:
    """Drive to talking distance of a person and faces them."""
    yield from keep_pace(robot, manner, travel(robot, person))


def approach(robot: Navigation, object: str, manner: str | None = None) -> Steps:
    """Drive until an object is within arm's reach, and face it."""
    yield from keep_pace(robot, manner, travel(robot, object))


def travel(robot: Navigation, name: str) -> Steps:
    """Drive to anything that has a name; brake when halted."""
    yield from accomplish(robot.navigate_to(name))


def choose(
    robot: MeetingRobot,
    type: str,
    how: str,
    output: Callable[[str], object],
    **parts: str,
) -> None:
    """Write the "nearest", a "random" name and so on of a type. Fails if there is none with these parts.

    The parts are those of a description: what it is like, what it isn't, and its relations. "speaking" is the person
    who spoke last, else the nearest one in view. For what is "sought" the description itself is written, as nothing
    like it may be known yet.
    """
    wanted = {name: text for name, text in parts.items() if text}
    if how == SOUGHT:
        output(Choice(NEAREST, type, type, tuple(wanted.items())).text)
        return
    chosen = speaker(robot) if how == _SPEAKING else robot.choose(type, how, wanted)
    if chosen is None or (how == _SPEAKING and wanted and chosen not in robot.described(type, wanted)):
        raise ActionFailed(unseen(type, wanted, describe_relations(wanted)))
    output(chosen)


def choose_all(robot: Base, type: str, output: Callable[[str], object], count: str = "", **parts: str) -> None:
    """Write the names of a type with these parts, nearest first. Fails if there are none, or too few."""
    wanted = {name: text for name, text in parts.items() if text}
    names = robot.described(type, wanted)
    if not names:
        raise ActionFailed(unseen(type, wanted, describe_relations(wanted)) if wanted else f"there's no {type}")
    if count and len(names) < int(count):
        raise ActionFailed(f"{count} are needed, but there's only {', '.join(names)}")
    output(";".join(names[: int(count)] if count else names))


def accomplish(operation: Operation) -> Steps:
    """Wait until an operation is done; cancel it when halted. Raises ActionFailed with the robot's reason."""
    try:
        while not operation.done:
            yield
    finally:
        operation.cancel()
    if operation.failure is not None:
        raise ActionFailed(operation.failure)


def go_to_side(
    robot: Navigation,
    side: str,
    place: str | None = None,
    person: str | None = None,
    object: str | None = None,
    zone: str | None = None,
    manner: str | None = None,
) -> Steps:
    """Drive to a side of a place, a person or an object, or to a part of a region, as the robot sees it.

    Fails for the middle, a corner or an edge of something without a region.
    """
    name = place or person or object or zone or ""
    inside = place is not None or zone is not None
    yield from keep_pace(robot, manner, _journey(robot, side, name, inside))


def _journey(robot: Navigation, side: str, name: str, may_be_region: bool) -> Steps:
    here = robot.pose.x, robot.pose.y
    spots = robot.zones.spots(name, here, inside=True) if may_be_region and robot.zones.has(name) else []
    if spots:
        faced = centre_of(spots)
        goal = _in_region(robot, side, name, here, faced, spots)
    elif side in _AHEAD:
        faced = robot.locate(name)
        goal = _beside(side, here, faced)
    else:
        raise ActionFailed(f"{said(name)} has no {side}: the world doesn't say how far it reaches")
    heading = Pose(*goal).bearing_to(faced) if dist(goal, faced) > 1e-6 else robot.pose.heading
    yield from accomplish(robot.navigate_to_pose(Pose(*goal, heading), f"the {side} of {said(name)}"))


def _in_region(robot: Navigation, side: str, name: str, here: Point, middle: Point, spots: list[Point]) -> Point:
    if side == "middle":
        return min(spots, key=lambda spot: dist(spot, middle))
    if side == "corner":
        corners = robot.zones.corners(name)
        return min(spots, key=lambda spot: min(dist(spot, corner) for corner in corners))
    if side not in _AHEAD:
        return spots[0]  # the nearest part of the edge
    ahead, left = _AHEAD[side]
    sight = middle[0] - here[0], middle[1] - here[1]

    def lies(spot: Point) -> float:
        offset = spot[0] - middle[0], spot[1] - middle[1]
        along = sight[0] * offset[0] + sight[1] * offset[1]
        across = sight[0] * offset[1] - sight[1] * offset[0]
        return ahead * along + left * across

    return max(spots, key=lies)


def _beside(side: str, here: Point, there: Point) -> Point:
    if dist(here, there) < 1e-6:
        raise RobotError("the robot stands there, and sees no side of it")
    ahead, left = _AHEAD[side]
    return Pose(*there, Pose(*here).bearing_to(there)).ahead(_BESIDE * ahead, _BESIDE * left)

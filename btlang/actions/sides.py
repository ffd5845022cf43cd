"""Journeys to one side of a thing, or to a part of a region: behind the table, the middle of the lab."""

from __future__ import annotations

from math import dist

from btlang.actions.manner import paced
from btlang.actions.motion import Steps
from btlang.actions.navigation import accomplish
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point, Pose, centre_of
from btlang.robots.robot import Navigation, RobotError
from btlang.robots.worlds.world import said

_BESIDE = 1.0
"""Metres from a thing at which the robot stands that goes to a side of it."""
_AHEAD = {"front": (-1.0, 0.0), "behind": (1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
"""How far along the sight of the robot, and to the left of it, each side lies."""


def go_to_side(
    robot: Navigation,
    side: str,
    place: str | None = None,
    person: str | None = None,
    object: str | None = None,
    zone: str | None = None,
    manner: str | None = None,
) -> Steps:
    """Drives to a side of a place, a person or an object, or to a part of a region, as the robot sees it.

    Fails for the middle, a corner or an edge of what has no region.
    """
    name = place or person or object or zone or ""
    inside = place is not None or zone is not None
    yield from paced(robot, manner, _journey(robot, side, name, inside))


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

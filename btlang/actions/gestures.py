"""Waving, pointing, nodding, looking, bowing and dancing. A gesture that is halted freezes where it is."""

from __future__ import annotations

from typing import Protocol

from btlang.actions.common import DrivingRobot, Watch, spot, where
from btlang.actions.joints import posture, take
from btlang.actions.motion import Steps, turn
from btlang.actions.navigation import accomplish
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point
from btlang.robots.robot import Base, Gesturing, Joints
from btlang.robots.worlds.world import said

_BOWED = 1.0  # seconds


class AimingRobot(Joints, Base, Protocol):
    """A robot that knows where it is, so it can point at what it knows."""


def wave(robot: AimingRobot, person: str | None = None) -> Steps:
    """Wave the right arm, towards the person if one is named, and let it hang again."""
    yield from _towards(robot, "wave", person) if person else take(robot, "wave")


def nod(robot: AimingRobot, person: str | None = None) -> Steps:
    """Nod the head, towards the person if one is named."""
    yield from _towards(robot, "nod", person) if person else take(robot, "nod")


def perform(
    robot: Gesturing,
    movement: str,
    person: str | None = None,
    object: str | None = None,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
) -> Steps:
    """Do a gesture of the robot file, aimed at what is named. Fails if that is out of reach."""
    name = person or object
    is_aimed = name or place or x is not None
    aim = None if not is_aimed else robot.locate(name) if name else where(robot, place, x, y)
    yield from accomplish(robot.gesture(movement, aim=aim))


def point_at_person(robot: AimingRobot, person: str) -> Steps:
    """Stretch the right arm towards a person."""
    yield from _towards(robot, "right arm pointing", person)


def point_at_object(robot: AimingRobot, object: str) -> Steps:
    """Stretch the right arm towards an object."""
    yield from _towards(robot, "right arm pointing", object)


def point_at_place(
    robot: AimingRobot, place: str | None = None, x: float | None = None, y: float | None = None
) -> Steps:
    """Stretch the right arm towards a place or a point."""
    yield from _towards(robot, "right arm pointing", place or spot(x, y), where(robot, place, x, y))


point_left = posture("left arm pointing", bearing=90.0)
point_right = posture("right arm pointing", bearing=-90.0)
point_ahead = posture("right arm pointing", bearing=0.0)
shake_head = posture("shake head")
look_around = posture("look around")
look_left = posture("look left")
look_right = posture("look right")
look_ahead = posture("look ahead")
look_up = posture("look up")
look_down = posture("look down")


def look_at_person(robot: AimingRobot, person: str) -> Steps:
    """Turn the head to a person. Fails if they are behind the robot."""
    yield from _towards(robot, "look at", person)


def look_at_object(robot: AimingRobot, object: str) -> Steps:
    """Turn the head to an object. Fails if it is behind the robot."""
    yield from _towards(robot, "look at", object)


def look_at_place(
    robot: AimingRobot, place: str | None = None, x: float | None = None, y: float | None = None
) -> Steps:
    """Turn the head to a place or a point. Fails if it is behind the robot."""
    yield from _towards(robot, "look at", place or spot(x, y), where(robot, place, x, y))


def _towards(robot: AimingRobot, posture: str, name: str, point: Point | None = None) -> Steps:
    """Turn to the point, by default that of the name. Raises ActionFailed if the joint doesn't turn so far."""
    bearing = robot.pose.bearing_to(robot.locate(name) if point is None else point)
    joint = robot.body.falls_short(posture, bearing)
    if joint is not None:
        where = "behind the robot" if abs(bearing) > 90.0 else "too far to the side"
        raise ActionFailed(f"{said(name)} is {where}; the {joint.part} can't turn that far")
    yield from take(robot, posture, bearing=bearing)


def bow(robot: Joints) -> Steps:
    """Lower the head for a second."""
    yield from take(robot, "look down")
    yield from Watch(robot).pause(_BOWED)
    yield from take(robot, "look ahead")


def dance(robot: DrivingRobot) -> Steps:
    """Swing from side to side on the spot, and turn once around."""
    for angle in (45.0, -90.0, 90.0, -45.0, 360.0):
        yield from turn(robot, angle)

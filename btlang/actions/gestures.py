"""Waving, pointing, nodding and looking. They never move the base; a halted gesture freezes where it is."""

from __future__ import annotations

from btlang.actions.joints import HANGING, STRETCHED, arm, bring
from btlang.actions.motion import Steps
from btlang.engine.leaf import ActionFailed
from btlang.robots.robot import Hand, Robot
from btlang.robots.world import said

_HEAD_LIMIT = 90.0


def wave(robot: Robot, person: str | None = None) -> Steps:
    """Waves the right arm, towards the person if one is named, and lets it hang again."""
    swing = _bearing(robot, person) if person else 0.0
    yield from bring(robot, arm("right", {"lift": 140.0, "swing": swing, "bend": 20.0}))
    for bend in (60.0, 20.0) * 3:
        yield from bring(robot, arm("right", {"bend": bend}))
    yield from bring(robot, arm("right", HANGING))


def point_at_person(robot: Robot, person: str) -> Steps:
    """Stretches the right arm towards a person."""
    yield from _point(robot, "right", _bearing(robot, person))


def point_at_object(robot: Robot, object: str) -> Steps:
    """Stretches the right arm towards an object."""
    yield from _point(robot, "right", _bearing(robot, object))


def point_at_place(robot: Robot, place: str) -> Steps:
    """Stretches the right arm towards a place."""
    yield from _point(robot, "right", _bearing(robot, place))


def point_left(robot: Robot) -> Steps:
    """Stretches the left arm to the left."""
    yield from _point(robot, "left", 90.0)


def point_right(robot: Robot) -> Steps:
    """Stretches the right arm to the right."""
    yield from _point(robot, "right", -90.0)


def point_ahead(robot: Robot) -> Steps:
    """Stretches the right arm ahead."""
    yield from _point(robot, "right", 0.0)


def nod(robot: Robot) -> Steps:
    """Nods the head twice."""
    for tilt in (-20.0, 0.0) * 2:
        yield from bring(robot, {"head tilt": tilt})


def shake_head(robot: Robot) -> Steps:
    """Turns the head from side to side."""
    for angle in (30.0, -30.0, 30.0, 0.0):
        yield from bring(robot, {"head turn": angle})


def look_around(robot: Robot) -> Steps:
    """Turns the head all the way to both sides and back ahead."""
    for angle in (_HEAD_LIMIT, -_HEAD_LIMIT, 0.0):
        yield from bring(robot, {"head turn": angle, "head tilt": 0.0})


def look_left(robot: Robot) -> Steps:
    """Turns the head to the left."""
    yield from bring(robot, {"head turn": 60.0, "head tilt": 0.0})


def look_right(robot: Robot) -> Steps:
    """Turns the head to the right."""
    yield from bring(robot, {"head turn": -60.0, "head tilt": 0.0})


def look_ahead(robot: Robot) -> Steps:
    """Turns the head straight ahead."""
    yield from bring(robot, {"head turn": 0.0, "head tilt": 0.0})


def look_up(robot: Robot) -> Steps:
    """Raises the head."""
    yield from bring(robot, {"head tilt": 30.0})


def look_down(robot: Robot) -> Steps:
    """Lowers the head."""
    yield from bring(robot, {"head tilt": -30.0})


def look_at_person(robot: Robot, person: str) -> Steps:
    """Turns the head to a person. Fails where they are behind the robot."""
    yield from _look(robot, person)


def look_at_object(robot: Robot, object: str) -> Steps:
    """Turns the head to an object. Fails where it is behind the robot."""
    yield from _look(robot, object)


def look_at_place(robot: Robot, place: str) -> Steps:
    """Turns the head to a place. Fails where it is behind the robot."""
    yield from _look(robot, place)


def _bearing(robot: Robot, name: str) -> float:
    return robot.pose.bearing_to(robot.locate(name))


def _point(robot: Robot, side: Hand, swing: float) -> Steps:
    yield from bring(robot, arm(side, {**STRETCHED, "swing": swing}))


def _look(robot: Robot, name: str) -> Steps:
    bearing = _bearing(robot, name)
    if abs(bearing) > _HEAD_LIMIT:
        raise ActionFailed(f"{said(name)} is behind the robot, where its head does not turn")
    yield from bring(robot, {"head turn": bearing, "head tilt": 0.0})

"""Doors, switches and zones."""

from __future__ import annotations

from typing import Protocol

from btlang.actions.common import DrivingRobot, keep_pace, where
from btlang.actions.motion import Steps, turn
from btlang.actions.navigation import accomplish, over_border, travel
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import centre_of
from btlang.robots.robot import Cautious, Handling, Messenger, Navigation, Perception
from btlang.robots.worlds.world import said


class DoorRobot(Navigation, Handling, Protocol):
    """A robot that finds its way to doors and switches."""


class PhotographingRobot(Perception, DrivingRobot, Protocol):
    """A robot that turns its camera to things."""


class DoorPhotographingRobot(PhotographingRobot, Handling, Protocol):
    """A robot that turns its camera to doors."""


def open_door(robot: DoorRobot, door: str) -> Steps:
    """Go to a door and open it."""
    yield from _move_door(robot, door, True)


def close_door(robot: DoorRobot, door: str) -> Steps:
    """Go to a door and close it. Fails if something is in it."""
    yield from _move_door(robot, door, False)


def go_to_door(robot: DoorRobot, door: str, manner: str | None = None) -> Steps:
    """Go to a door, on the side from which it can be reached, and face it."""
    yield from keep_pace(robot, manner, _to_door(robot, door))


def _move_door(robot: DoorRobot, door: str, is_open: bool) -> Steps:
    yield from _to_door(robot, door)
    yield from accomplish(robot.move_door(door, is_open))


def _to_door(robot: DoorRobot, door: str) -> Steps:
    *others, last = robot.beside_door(door)
    for spot in others:
        try:
            yield from accomplish(robot.navigate_to_pose(spot))
        except ActionFailed:
            continue  # it may be reached from its other side
        break
    else:
        yield from accomplish(robot.navigate_to_pose(last))


def door_is_open(robot: Handling, door: str) -> bool:
    """Return whether a door is open."""
    return robot.is_open(door)


def door_is_closed(robot: Handling, door: str) -> bool:
    """Return whether a door is closed."""
    return not robot.is_open(door)


def switch_on(robot: DoorRobot, object: str) -> Steps:
    """Go to something and switch it on."""
    yield from _switch(robot, object, True)


def switch_off(robot: DoorRobot, object: str) -> Steps:
    """Go to something and switch it off."""
    yield from _switch(robot, object, False)


def push_button(robot: DoorRobot, object: str) -> Steps:
    """Go to something and push its button: on becomes off, and off on."""
    yield from _switch(robot, object, None)


def _switch(robot: DoorRobot, name: str, on: bool | None) -> Steps:
    yield from travel(robot, name)
    yield from accomplish(robot.switch(name, on))


def is_switched_on(robot: Handling, object: str) -> bool:
    """Return whether something is switched on."""
    return robot.is_on(object)


def is_switched_off(robot: Handling, object: str) -> bool:
    """Return whether something is switched off."""
    return not robot.is_on(object)


def enter_zone(robot: Cautious, zone: str, manner: str | None = None) -> Steps:
    """Drive into a zone, the nearest way first. Does nothing if the robot is in it."""
    yield from keep_pace(robot, manner, over_border(robot, zone, inside=True))


def leave_zone(robot: Cautious, zone: str, manner: str | None = None) -> Steps:
    """Drive out of a zone, the nearest way first. Does nothing if the robot is outside."""
    yield from keep_pace(robot, manner, over_border(robot, zone, inside=False))


def avoid_zone(robot: Cautious, zone: str) -> None:
    """Keep out of a zone until the mission ends, or it is opened."""
    robot.zones.close(zone)


def stay_in_zone(robot: Cautious, zone: str) -> None:
    """Stay in a zone until the mission ends."""
    robot.zones.keep_in(zone).begin()


def open_zone(robot: Cautious, zone: str) -> None:
    """Let the robot into a zone again."""
    robot.zones.open(zone)


def zone_is_closed(robot: Cautious, zone: str) -> bool:
    """Return whether the robot keeps out of a zone."""
    return robot.zones.is_closed(zone)


def in_zone(robot: Cautious, zone: str) -> bool:
    """Return whether the robot is in a zone."""
    return robot.zones.contains(zone, (robot.pose.x, robot.pose.y))


def someone_in_the_way(robot: Cautious) -> bool:
    """Return whether somebody is in the way of the robot's journey."""
    return bool(robot.held_up)


def wait_for_way(robot: Cautious, duration: float) -> None:
    """Set how long the robot waits for somebody in its way before it looks for another way."""
    robot.wait_for_way(duration)


def clear_map(robot: Cautious) -> None:
    """Forget what was seen on the way."""
    robot.forget_map()


def call_staff(robot: Messenger, text: str | None = None) -> None:
    """Call whoever watches the robot."""
    robot.call(text or "the robot needs help")


def raise_alarm(robot: Messenger, text: str | None = None) -> None:
    """Call whoever watches the robot, urgently."""
    robot.call(f"ALARM: {text}" if text else "ALARM")


def sees(robot: Perception, object: str) -> bool:
    """Return whether an object is in view."""
    return robot.sees(object)


def sees_person(robot: Perception, person: str) -> bool:
    """Return whether a person is in view."""
    return robot.sees(person)


def sees_someone(robot: Perception) -> bool:
    """Return whether anybody is in view."""
    return bool(robot.seen("person"))


def take_picture(robot: PhotographingRobot) -> Steps:
    """Take a picture of what is in view."""
    yield from accomplish(robot.take_picture())


def take_picture_of_person(robot: PhotographingRobot, person: str) -> Steps:
    """Turn to a person and take a picture."""
    yield from _take_picture_of(robot, person)


def take_picture_of_object(robot: PhotographingRobot, object: str) -> Steps:
    """Turn to an object and take a picture."""
    yield from _take_picture_of(robot, object)


def take_picture_of_place(
    robot: PhotographingRobot, place: str | None = None, x: float | None = None, y: float | None = None
) -> Steps:
    """Turn to a place or a point and take a picture."""
    yield from turn(robot, robot.pose.bearing_to(where(robot, place, x, y)))
    yield from accomplish(robot.take_picture())


def take_picture_of_door(robot: DoorPhotographingRobot, door: str) -> Steps:
    """Turn to a door and take a picture."""
    spots = robot.beside_door(door)
    yield from turn(robot, robot.pose.bearing_to(centre_of([(spot.x, spot.y) for spot in spots])))
    yield from accomplish(robot.take_picture())


def _take_picture_of(robot: PhotographingRobot, name: str) -> Steps:
    yield from turn(robot, robot.pose.bearing_to(robot.locate(name)))
    if not robot.sees(name):
        raise ActionFailed(f"I don't see {said(name)}")
    yield from accomplish(robot.take_picture())

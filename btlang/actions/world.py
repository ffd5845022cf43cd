"""Doors, switches and zones."""

from __future__ import annotations

from btlang.actions.motion import Steps
from btlang.actions.navigation import accomplish
from btlang.robots.capabilities import Cautious, Handling, Messenger, Perception


def open_door(robot: Handling, door: str) -> Steps:
    """Opens a door within reach."""
    yield from accomplish(robot.move_door(door, True))


def close_door(robot: Handling, door: str) -> Steps:
    """Closes a door within reach. Fails where something is in it."""
    yield from accomplish(robot.move_door(door, False))


def door_is_open(robot: Handling, door: str) -> bool:
    """Whether a door is open."""
    return robot.is_open(door)


def door_is_closed(robot: Handling, door: str) -> bool:
    """Whether a door is closed."""
    return not robot.is_open(door)


def switch_on(robot: Handling, object: str) -> Steps:
    """Switches something within reach on."""
    yield from accomplish(robot.switch(object, True))


def switch_off(robot: Handling, object: str) -> Steps:
    """Switches something within reach off."""
    yield from accomplish(robot.switch(object, False))


def push_button(robot: Handling, object: str) -> Steps:
    """Pushes something within reach: on becomes off, and off on."""
    yield from accomplish(robot.switch(object, None))


def is_switched_on(robot: Handling, object: str) -> bool:
    """Whether something is switched on."""
    return robot.is_on(object)


def is_switched_off(robot: Handling, object: str) -> bool:
    """Whether something is switched off."""
    return not robot.is_on(object)


def avoid_zone(robot: Cautious, zone: str) -> None:
    """Keeps out of a zone until the mission ends, or it is opened."""
    robot.zones.close(zone)


def open_zone(robot: Cautious, zone: str) -> None:
    """The robot may go into a zone again."""
    robot.zones.open(zone)


def zone_is_closed(robot: Cautious, zone: str) -> bool:
    """Whether the robot keeps out of a zone."""
    return robot.zones.is_closed(zone)


def in_zone(robot: Cautious, zone: str) -> bool:
    """Whether the robot is in a zone."""
    return robot.zones.contains(zone, (robot.pose.x, robot.pose.y))


def someone_in_the_way(robot: Cautious) -> bool:
    """Whether somebody is in the way of the robot's journey."""
    return bool(robot.held_up)


def wait_for_way(robot: Cautious, duration: float) -> None:
    """On later journeys the robot waits so long for who is in its way, then it looks for another way."""
    robot.wait_for_way(duration)


def go_another_way(robot: Cautious) -> None:
    """The journey under way goes on around who is in the way."""
    robot.go_another_way()


def clear_map(robot: Cautious) -> None:
    """Forgets what was seen on the way."""
    robot.forget_map()


def call_staff(robot: Messenger, text: str = "the robot needs help") -> None:
    """Calls whoever watches the robot."""
    robot.call(text)


def raise_alarm(robot: Messenger, text: str = "alarm") -> None:
    """Calls whoever watches the robot, urgently."""
    robot.call(f"ALARM: {text}")


def sees(robot: Perception, object: str) -> bool:
    """Whether an object is in view."""
    return robot.sees(object)


def sees_person(robot: Perception, person: str) -> bool:
    """Whether a person is in view."""
    return robot.sees(person)


def sees_someone(robot: Perception) -> bool:
    """Whether anybody is in view."""
    return bool(robot.seen("person"))

"""What noun phrases stand for: `the red cup`, `the people in green coats`."""

from __future__ import annotations

from btlang.robots.robot import Base


def described(robot: Base, type: str, **parts: str) -> list[str]:
    """The names of the type "object" or "person" with these parts that the robot knows, nearest first.

    The parts are `kind`, `color` and `use` of objects, `clothing`, `color` and `gesture` of people; "" is any.
    """
    return robot.described(type, {name: text for name, text in parts.items() if text})

"""How the robot goes its ways: slowly, carefully, quietly or quickly."""

from __future__ import annotations

from collections.abc import Generator

from btlang.robots.robot import Base

_SHARES = {"slowly": 0.5, "carefully": 0.5, "quietly": 0.4}
"""Of the normal speed. Who goes quickly goes as fast as the robot can."""


def paced(robot: Base, manner: str | None, steps: Generator[None, None, None]) -> Generator[None, None, None]:
    """Does the steps in this manner, without one at the pace there is; halted, they are halted."""
    if manner is None:
        yield from steps
        return
    before, robot.pace = robot.pace, share_of(robot, manner)
    try:
        yield from steps
    finally:
        robot.pace = before


def share_of(robot: Base, manner: str | None) -> float:
    """The share of the normal speed; 1 without a manner."""
    return 1.0 if manner is None else _SHARES.get(manner, robot.max_speed / robot.normal_speed)

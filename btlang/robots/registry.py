"""Which robots a mission can run on: by name, what connects to one."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.robots.world import World
    from btlang.run.connection import Connection

    Connect: TypeAlias = Callable[[World], Connection]

ROBOTS = {
    "simulated": "btlang.robots.simulation:Simulation",
    "ros": "btlang.ros.command:connect_ros",
    "actions": "btlang.ros.command:connect_actions",
}
"""Functions of a world, by the name of the robot; imported when it is asked for."""


def connector(robot: str | Connect) -> Connect:
    """What connects to a robot: that of a name in ROBOTS, or the function given. Raises ValueError."""
    if not isinstance(robot, str):
        return robot
    if robot not in ROBOTS:
        raise ValueError(f"robot is {' or '.join(map(repr, ROBOTS))}, or a function that connects to one: {robot!r}")
    module, _, name = ROBOTS[robot].partition(":")
    made: Connect = getattr(import_module(module), name)
    return made

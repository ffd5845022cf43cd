"""Which robots a mission can run on: by name, what makes the stage of a run."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.robots.world import World
    from btlang.run.stage import Stage

    MakeStage: TypeAlias = Callable[[World], Stage]

ROBOTS = {
    "simulated": "btlang.robots.simulation:Simulation",
    "ros": "btlang.ros.command:ros_stage",
    "actions": "btlang.ros.command:actions_stage",
}
"""Functions of a world, by the name of the robot; imported when it is asked for."""


def stage_maker(robot: str | MakeStage) -> MakeStage:
    """What makes the stage of a run: that of a name in ROBOTS, or the function given. Raises ValueError."""
    if not isinstance(robot, str):
        return robot
    if robot not in ROBOTS:
        raise ValueError(f"robot is {' or '.join(map(repr, ROBOTS))}, or a function that makes a stage: {robot!r}")
    module, _, name = ROBOTS[robot].partition(":")
    made: MakeStage = getattr(import_module(module), name)
    return made

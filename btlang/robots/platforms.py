"""What a robot can run on: by name, what connects to it; and the options of the command line about robots."""

from __future__ import annotations

from argparse import ArgumentParser
from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

ROBOTS = {
    "simulated": "btlang.robots.simulation.connection:Simulation",
    "devices": "btlang.components.device_robot:connect_devices",
    "ros": "btlang.ros.connectors:connect_ros",
    "actions": "btlang.ros.connectors:connect_actions",
}
"""Functions of a world and a body that connect to a robot, by what it runs on. They are imported when needed."""

ALL = "all"
"""The value of --simulate for all devices of a robot."""
COMPONENTS = "btlang.components.connection:component_connection"
"""The function that adds the components and devices of a body to a connection."""
NODES = "btlang.ros.connectors:component_nodes"
"""The function that makes the node for components that are ROS 2 nodes."""


def import_function(place: str) -> Callable[..., Any]:
    """Import a function by its `module:name`, such as those above."""
    module, _, function = place.partition(":")
    made: Callable[..., Any] = getattr(import_module(module), function)
    return made


def add_simulate(parser: ArgumentParser) -> None:
    """Add the option --simulate."""
    parser.add_argument(
        "--simulate", action="append", nargs="?", const=ALL, default=[], metavar="DEVICE",
        help="simulate all devices of the robot file, or only those of this name or kind",
    )  # fmt: skip


def add_robot_words(parser: ArgumentParser) -> None:
    """Add the option --robot of a verb that only reads missions."""
    parser.add_argument(
        "--robot",
        default="",
        metavar="ROBOT",
        help="read missions with the words and the world of this robot: a robot file or a name",
    )


def add_world(parser: ArgumentParser) -> None:
    """Add the option --world."""
    parser.add_argument("--world", metavar="FILE", help="world file (default: the world that ships)")

"""What a robot can run on: by name, what connects to it."""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from btlang.run.connection import Connection

ROBOTS = {
    "simulated": "btlang.robots.simulation:Simulation",
    "devices": "btlang.components.device_robot:connect_devices",
    "ros": "btlang.ros.connectors:connect_ros",
    "actions": "btlang.ros.connectors:connect_actions",
}
"""Functions of a world and a body, by what the robot runs on; imported when it is asked for."""


ALL = "all"
"""For --simulate: all devices of a robot."""
COMPONENTS = "btlang.components.connection:component_connection"
"""What adds the components and devices of a body to a connection."""

NODES = "btlang.ros.connectors:component_nodes"
"""What leads the components of a body that are ROS 2 nodes."""


def connection_function(name: str) -> Callable[..., Connection]:
    """What connects to a robot, by a name in ROBOTS."""
    return _imported(ROBOTS[name])


def component_function() -> Callable[..., Connection]:
    """That of COMPONENTS."""
    return _imported(COMPONENTS)


def node_function() -> Callable[..., Any]:
    """That of NODES."""
    return _imported(NODES)


def _imported(place: str) -> Callable[..., Any]:
    module, _, function = place.partition(":")
    made: Callable[..., Any] = getattr(import_module(module), function)
    return made

"""Functions that connect to ROS 2 robots, by names of btlang/robots/platforms.py. Importing them imports no ROS."""

from __future__ import annotations

from importlib.util import find_spec

from btlang.ros.available import require_interfaces, require_ros, unusable
from btlang.ros.serving.names import FOLDER

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body
    from btlang.robots.worlds.world import World
    from btlang.ros.components.host import ComponentNodes
    from btlang.ros.robot.connection import RosConnection

_PACKAGES = ("geometry_msgs", "nav_msgs", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs", "trajectory_msgs")

_COMPILE = "Compile it: python -m btlang.ros.interfaces tests/ros/composition_interfaces, in a clone of btlang"


def connect_ros(world: World, **options: Any) -> RosConnection:
    """Connect to a ROS 2 robot, with the options of RosConnection. Raises MissionError (BT100) without ROS 2."""
    require_ros(*_PACKAGES)
    from btlang.ros.robot.connection import RosConnection

    return RosConnection(world, **options)


def connect_actions(world: World, *, namespace: str = "", servers: str = "", **options: Any) -> RosConnection:
    """Connect to a ROS 2 robot whose actions are done by servers, by default those of the same namespace.

    Raises MissionError (BT100, BT110).
    """
    require_ros(*_PACKAGES)
    require_interfaces()
    servers = servers or f"/{namespace.strip('/')}/{FOLDER}".replace("//", "/")
    return connect_ros(world, namespace=namespace, servers=servers, **options)


def component_nodes(robot: Any, body: Body) -> ComponentNodes:
    """Make what leads the components of a robot that are nodes. Raises MissionError (BT100) without ROS 2."""
    containers = any(part.node is not None and part.node.container for part in body.components)
    require_ros("lifecycle_msgs", "rcl_interfaces", "std_msgs")
    if containers and find_spec("composition_interfaces") is None:
        raise unusable("there is no Python package composition_interfaces", _COMPILE)
    from btlang.ros.components.host import ComponentNodes

    return ComponentNodes(robot)

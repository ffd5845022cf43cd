"""What a ROS 2 robot looks like to a mission: its topics, services and actions, and which of them a leaf needs."""

from __future__ import annotations

from collections.abc import Collection

from btlang.robots.bodies.body import Body
from btlang.robots.preflight import needs_of
from btlang.support.record import Record
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.vocabulary.lexicon import Lexicon

VELOCITY = "cmd_vel"
"""The topic of velocities; its type is Twist, or TwistStamped if the robot listens to that."""
ONE_SOURCE = ("odom", "clock", "battery_state", "docked")
"""Topics on which two publishers would contradict one another."""
_HAND = "std_srvs/srv/SetBool"
_HOLDING = "std_msgs/msg/String"


class Interface(Record):
    """An interface of the robot: `kind` is "publisher" or "listener" of a topic, "service", "action" or "node".

    A name without a leading slash is in the namespace of the robot. `type` is written as in ROS 2 tools. One that
    `flows` reports its state to listeners, at once or repeatedly, so that silence is a fault.
    """

    kind: str
    name: str
    type: str
    flows: bool = False

    @property
    def sort(self) -> str:
        """The word for it in ROS 2."""
        return "topic" if self.kind in ("publisher", "listener") else self.kind


CLOCK = Interface("publisher", "/clock", "rosgraph_msgs/msg/Clock", flows=True)
_BASE = (
    Interface("listener", VELOCITY, "geometry_msgs/msg/Twist"),
    Interface("publisher", "odom", "nav_msgs/msg/Odometry", flows=True),
)
_JOINTS = (
    Interface("listener", "joint_trajectory", "trajectory_msgs/msg/JointTrajectory"),
    Interface("publisher", "joint_states", "sensor_msgs/msg/JointState", flows=True),
)
_CAPABILITIES: dict[str, tuple[Interface, ...]] = {
    "base": _BASE,
    "pose": _BASE[1:],
    "navigation": (Interface("action", "navigate_to_pose", "nav2_msgs/action/NavigateToPose"), *_BASE[1:]),
    "scanner": (Interface("publisher", "scan", "sensor_msgs/msg/LaserScan", flows=True),),
    "bumper": (Interface("publisher", "bump", "std_msgs/msg/String"),),
    "battery": (Interface("publisher", "battery_state", "sensor_msgs/msg/BatteryState", flows=True),),
    "charging": (Interface("publisher", "battery_state", "sensor_msgs/msg/BatteryState"),),
    "docked": (Interface("publisher", "docked", "std_msgs/msg/Bool", flows=True),),
    "docking": (
        Interface("service", "dock", "std_srvs/srv/Trigger"),
        Interface("service", "undock", "std_srvs/srv/Trigger"),
    ),
    "joints": _JOINTS,
    "ears": (Interface("publisher", "heard", "btlang_interfaces/msg/Heard"),),
    "perception": (Interface("publisher", "sightings", "btlang_interfaces/msg/Sightings", flows=True),),
    "voice": (Interface("listener", "speech", "std_msgs/msg/String"),),
    "screen": (Interface("listener", "print", "std_msgs/msg/String"),),
}
ALTERNATIVES: dict[str, tuple[Interface, ...]] = {
    "dock": (Interface("action", "dock_robot", "nav2_msgs/action/DockRobot"), _CAPABILITIES["docking"][0]),
    "undock": (Interface("action", "undock_robot", "nav2_msgs/action/UndockRobot"), _CAPABILITIES["docking"][1]),
    "docked": (*_CAPABILITIES["docked"], *_CAPABILITIES["battery"]),
}
"""The interfaces that may replace one, by its name: the first that the robot has is used."""


def interfaces(need: str, body: Body) -> tuple[Interface, ...]:
    """Return the interfaces for something that a word needs; none for what is unknown."""
    hands = [hand.name for hand in body.hands]
    if need == "holding":
        return tuple(Interface("publisher", f"{hand}_hand/holding", _HOLDING, flows=True) for hand in hands)
    if need == "hand" or need.removesuffix(" hand") in hands:
        wanted = hands if need == "hand" else [need.removesuffix(" hand")]
        return tuple(Interface("service", f"{hand}_hand/close", _HAND) for hand in wanted)
    if any(joint.part == need for joint in body.joints):
        return _JOINTS
    return _CAPABILITIES.get(need, ())


def needs(tree: Tree, vocabulary: Lexicon, body: Body, but: Collection[str] = ()) -> dict[Interface, Node]:
    """Return what a tree needs of the robot, each with the first leaf that needs it; leaves with ids in `but` don't
    count.
    """
    found: dict[Interface, Node] = {}
    for node in tree.walk():
        for need in needs_of(node, vocabulary) if node.id not in but else ():
            for interface in interfaces(need, body):
                found.setdefault(interface, node)
    return found

"""What a ROS 2 robot looks like to a mission: its topics, services and actions, and which of them a leaf needs."""

from __future__ import annotations

from collections.abc import Collection

from btlang.record import Record
from btlang.tree.node import Node, Tree


class Interface(Record):
    """What the robot has to offer: `kind` is "publisher" or "listener" of a topic, "service", "action" or "node".

    A name without a slash before it is in the namespace of the robot. `type` is as ROS 2 tools write it. What `flows`
    tells who listens how it is, at once or again and again, so that silence is a fault.
    """

    kind: str
    name: str
    type: str
    flows: bool = False

    @property
    def sort(self) -> str:
        """What it is in ROS 2."""
        return "topic" if self.kind in ("publisher", "listener") else self.kind


VELOCITY = "cmd_vel"
"""The topic whose type is Twist, or TwistStamped where the robot listens to that."""
CLOCK = Interface("publisher", "/clock", "rosgraph_msgs/msg/Clock", flows=True)
_BASE = (
    Interface("listener", VELOCITY, "geometry_msgs/msg/Twist"),
    Interface("publisher", "odom", "nav_msgs/msg/Odometry", flows=True),
)
_HAND = "std_srvs/srv/SetBool"
_HOLDING = "std_msgs/msg/String"
CAPABILITIES: dict[str, tuple[Interface, ...]] = {
    "base": _BASE,
    "pose": _BASE[1:],
    "navigation": (Interface("action", "navigate_to_pose", "nav2_msgs/action/NavigateToPose"), *_BASE[1:]),
    "scan": (Interface("publisher", "scan", "sensor_msgs/msg/LaserScan", flows=True),),
    "bump": (Interface("publisher", "bump", "std_msgs/msg/String"),),
    "battery": (Interface("publisher", "battery_state", "sensor_msgs/msg/BatteryState", flows=True),),
    "charging": (Interface("publisher", "battery_state", "sensor_msgs/msg/BatteryState"),),
    "docked": (Interface("publisher", "docked", "std_msgs/msg/Bool", flows=True),),
    "docking": (
        Interface("service", "dock", "std_srvs/srv/Trigger"),
        Interface("service", "undock", "std_srvs/srv/Trigger"),
    ),
    "joints": (
        Interface("listener", "joint_trajectory", "trajectory_msgs/msg/JointTrajectory"),
        Interface("publisher", "joint_states", "sensor_msgs/msg/JointState", flows=True),
    ),
    "left hand": (Interface("service", "left_hand/close", _HAND),),
    "right hand": (Interface("service", "right_hand/close", _HAND),),
    "holding": (
        Interface("publisher", "left_hand/holding", _HOLDING, flows=True),
        Interface("publisher", "right_hand/holding", _HOLDING, flows=True),
    ),
    "voice": (Interface("listener", "speech", "std_msgs/msg/String"),),
    "print": (Interface("listener", "print", "std_msgs/msg/String"),),
}
"""What the robot needs for each thing that it can do."""

_DOES = {
    ("base",): "MoveForward MoveBackward TurnLeft TurnRight TurnAround Stop Stuck FacePlace FacePerson FaceObject",
    ("navigation",): "GoTo GoToPerson Approach",
    ("navigation", "docking", "docked"): "Dock",
    ("base", "docking", "docked"): "Undock",
    ("navigation", "docking", "docked", "battery"): "Charge",
    ("joints",): (
        "Wave PointLeft PointRight PointAhead Nod ShakeHead LookAround LookLeft LookRight LookAhead LookUp LookDown "
        "RaiseArm RaiseLeftArm RaiseBothArms LowerArm LowerLeftArm LowerBothArms StretchArm StretchLeftArm "
        "RetractArm RetractLeftArm"
    ),
    ("joints", "pose"): "PointAtPerson PointAtObject PointAtPlace LookAtPerson LookAtObject LookAtPlace",
    ("voice",): "Say",
    ("print",): "Print",
    ("scan",): "WallInFront WallOnLeft WallOnRight WallBehind PathClear DistanceAhead",
    ("bump",): "Bumped",
    ("battery",): "BatteryLow BatteryFull Battery",
    ("charging",): "Charging",
    ("docked",): "Docked",
    ("pose",): (
        "AtPlace PersonNear SomeoneNear PeopleNear DistanceToPlace DistanceToPerson DistanceToObject"
    ),
    ("holding",): "Holding HoldingSomething HandEmpty",
    ("left hand",): "OpenLeftHand CloseLeftHand",
    ("right hand",): "OpenHand CloseHand Grasp",
    ("left hand", "right hand", "holding"): "Release",
    ("left hand", "right hand", "holding", "joints"): "PutDown",
    ("navigation", "right hand", "holding", "joints"): "PickUp",
}  # fmt: skip
LEAVES = {leaf: capabilities for capabilities, leaves in _DOES.items() for leaf in leaves.split()}
"""What the leaves that ship need the robot to be able to do, by their ids."""


def needs(tree: Tree, but: Collection[str] = ()) -> dict[Interface, Node]:
    """What a tree needs of the robot, each with the first leaf that needs it; but for leaves of some ids."""
    found: dict[Interface, Node] = {}
    for node in tree.walk():
        for capability in LEAVES.get(node.id, ()) if node.id not in but else ():
            for interface in CAPABILITIES[capability]:
                found.setdefault(interface, node)
    return found

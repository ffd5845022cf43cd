"""The joints of a ROS 2 robot: a JointTrajectory out, JointState in."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil

from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from btlang.robots.bodies.body import Body
from btlang.robots.motion.guard.tracking import JointProgress
from btlang.robots.robot import RobotError, clip_targets, joint_of
from btlang.ros.clocks import AWAKE
from btlang.ros.messages import trajectory
from btlang.ros.subscriptions import SubscriptionCache

STATES, TRAJECTORY = "joint_states", "joint_trajectory"
_SILENT = 2.0  # seconds without joint states


class JointStates:
    """The angles of joints: degrees here, radians in messages, metres in both for a joint that slides.

    In messages names have `_` for blanks.
    """

    def __init__(self, subscriptions: SubscriptionCache, body: Body) -> None:
        self._subscriptions, self._body = subscriptions, body
        subscriptions.listen(STATES, JointState, "joint states")

    def find_unreported(self) -> list[str]:
        """Return the joints of the body that haven't been reported yet, although others have."""
        states = self._subscriptions.latest_joints(STATES)
        return states.missing(on_wire(joint.name) for joint in self._body.joints) if states.has_come else []

    def angle(self, name: str) -> float:
        """Return the angle of a joint. Raises RobotError for an unknown joint, or if the joint states are silent."""
        return self.find_stamped(name)[0]

    def find_stamped(self, name: str) -> tuple[float, float]:
        """Return the angle of a joint with the time stamp of its message. Raises as `angle`."""
        joint = joint_of(self._body, name)
        self._subscriptions.get(STATES, _SILENT)
        position, stamp = self._subscriptions.latest_joints(STATES).position(on_wire(name), _SILENT)
        return position / joint.si, stamp


def on_wire(name: str) -> str:
    """Return the name of a joint in messages."""
    return name.replace(" ", "_")


class RosJoints:
    """Joints that are commanded one point at a time; how they get there is up to the robot."""

    def __init__(self, node: Node, subscriptions: SubscriptionCache, body: Body) -> None:
        self._body = body
        self._states = JointStates(subscriptions, body)
        self._targets: dict[str, float] = {}
        self._progress = JointProgress(body, AWAKE.now)
        self._publisher = node.create_publisher(JointTrajectory, TRAJECTORY, 10)

    def find_unreported(self) -> list[str]:
        return self._states.find_unreported()

    @property
    def moving(self) -> bool:
        """Whether a joint is on its way."""
        return bool(self._targets)

    def angle(self, name: str) -> float:
        return self._states.angle(name)

    def step(self) -> None:
        """Do nothing: the joints move by themselves."""

    def move(self, targets: Mapping[str, float]) -> None:
        """Set off towards the targets, clipped to the limits. Raises RobotError as `angle` does."""
        goals = clip_targets(self._body, targets)
        times = (abs(goal - self.angle(name)) / joint_of(self._body, name).speed for name, goal in goals.items())
        self._publish(goals, max(times, default=0.0))
        self._targets.update(goals)
        self._progress.start(goals)

    def at_target(self, names: tuple[str, ...]) -> bool:
        """Return whether none of these joints is on its way. Raises RobotError if one of them is stuck."""
        for name in names:
            target = self._targets.get(name)
            if target is not None and self._progress.has_arrived(name, target - self.angle(name)):
                self._targets.pop(name, None)
        return not any(name in self._targets for name in names)

    def freeze(self, names: tuple[str, ...] = ()) -> None:
        """Hold these joints, or all if none are named, where they are."""
        under_way = [name for name in (names or tuple(self._targets)) if self._targets.pop(name, None) is not None]
        try:
            self._publish({name: self.angle(name) for name in under_way}, 0.0)
        except RobotError:
            return  # nobody knows where they are

    def _publish(self, targets: Mapping[str, float], seconds: float) -> None:
        if not targets:
            return
        angles = {on_wire(name): target * joint_of(self._body, name).si for name, target in targets.items()}
        self._publisher.publish(trajectory(angles, ceil(seconds)))

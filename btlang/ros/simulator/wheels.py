"""The wheels and the topics that say where the robot is: /cmd_vel, /odom, /amcl_pose, /bump."""

from __future__ import annotations

from math import degrees, isfinite, radians
from time import monotonic

from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import String

from btlang.robots.simulated import SimulatedRobot
from btlang.ros.node import LATCHED
from btlang.ros.poses import BASE, MAP, ODOM, pose_message
from btlang.ros.simulator.call_queue import CallQueue
from btlang.ros.simulator.publishing import COMMANDS, Every, Moment

_SILENCE = 0.5  # simulated seconds without a command after which the robot brakes
_ON_THE_WAY = 0.3  # real seconds for which velocities that were sent before a goal may still arrive


class Wheels:
    """Drives as /cmd_vel says. A journey ends with a command to move; a zero, or silence, leaves it alone."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._driven = self._rolls = False
        self._commanded_at = 0.0
        self._ignored_until = 0.0
        self._odometry = node.create_publisher(Odometry, "odom", COMMANDS)
        self._pose = node.create_publisher(PoseWithCovarianceStamped, "amcl_pose", LATCHED)
        self._bump = node.create_publisher(String, "bump", COMMANDS)
        self._due = Every(20)
        node.create_subscription(Twist, "cmd_vel", lambda twist: calls.post(lambda: self._drive(twist)), COMMANDS)

    def watch(self) -> None:
        """Brakes where commands have ceased; to be called before each step."""
        if self._driven and self._robot.time - self._commanded_at >= _SILENCE - 1e-6:
            self._driven = self._rolls = False
            self._robot.drive(0.0, 0.0)

    @property
    def driven(self) -> bool:
        """Whether commands drive the robot."""
        return self._driven

    def leave(self) -> None:
        """A goal drives from now on, also if velocities that were sent before it arrive behind it."""
        if self._rolls:
            self._ignored_until = monotonic() + _ON_THE_WAY
        self._driven = self._rolls = False

    def bumped(self, into: str) -> None:
        """A contact has just begun."""
        self._bump.publish(String(data=into))

    def publish(self, now: Moment) -> None:
        """Publishes where the robot is and how it moves."""
        if not self._due.is_due(now.seconds):
            return
        linear, angular = self._robot.velocity
        odometry = Odometry(child_frame_id=BASE)
        odometry.header.stamp, odometry.header.frame_id = now.stamp, ODOM
        odometry.pose.pose = pose_message(self._robot.pose)
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = linear, radians(angular)
        self._odometry.publish(odometry)
        pose = PoseWithCovarianceStamped()
        pose.header.stamp, pose.header.frame_id = now.stamp, MAP
        pose.pose.pose = odometry.pose.pose
        self._pose.publish(pose)

    def _drive(self, twist: Twist) -> None:
        linear, angular = twist.linear.x, degrees(twist.angular.z)
        if not (isfinite(linear) and isfinite(angular)):
            return
        rolls = bool(linear or angular)
        if not rolls:
            self._ignored_until = 0.0
        elif monotonic() < self._ignored_until:
            return
        if self._driven or rolls:
            self._driven, self._rolls, self._commanded_at = True, rolls, self._robot.time
            self._robot.drive(linear, angular)

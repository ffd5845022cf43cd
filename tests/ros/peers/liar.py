"""The form of the liar that is a ROS 2 node: a robot without a watchdog, whose sensors lie as /lie says.

/lie takes JSON. `{"lies": [NAMES], ...}` begins a scene: its other keys are those of tests.lies.scene.Scene, `skew`
(the seconds that the clock of the robot is ahead) and `rate` (of the odometry, a second). It prints `scene`. `{}`
prints `result JSON`: see tests.lies.scene.Result.
"""

from __future__ import annotations

import json
import math
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from btlang.ros.messages import stamp
from tests.lies.lies import BY_NAME
from tests.lies.scene import Scene
from tests.ros.peers.peer import serve, tell

PERIOD, SCANS = 0.02, 0.1


class LyingNode:
    """Moves the true robot of a scene and publishes what its sensors say."""

    scene: Scene

    def __init__(self, node: Node) -> None:
        self.node = node
        self.begin(String(data='{"lies": []}'))
        node.create_subscription(Twist, "cmd_vel", self.drive, 10)
        node.create_subscription(JointTrajectory, "joint_trajectory", self.move, 10)
        node.create_subscription(String, "lie", self.begin, 10)
        self.odometry = node.create_publisher(Odometry, "odom", 10)
        self.scans = node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self.states = node.create_publisher(JointState, "joint_states", 10)
        node.create_timer(PERIOD, self.step)

    def begin(self, message: String) -> None:
        asked = json.loads(message.data)
        if not asked:
            tell("result", json.dumps(self.scene.result.data()))
            return
        self.skew, self.period = asked.pop("skew", 0.0), 1.0 / asked.pop("rate", 50.0) - PERIOD / 2
        self.scene = Scene([BY_NAME[name] for name in asked.pop("lies")], **asked)
        self.then, self.told, self.scanned = time.monotonic(), 0.0, 0.0
        tell("scene")

    def drive(self, twist: Twist) -> None:
        self.scene.drive(twist.linear.x, math.degrees(twist.angular.z))

    def move(self, trajectory: JointTrajectory) -> None:
        for name, position in zip(trajectory.joint_names, trajectory.points[-1].positions, strict=True):
            if name == "head_turn":
                self.scene.robot.joint_target = math.degrees(position)

    def step(self) -> None:
        now = time.monotonic()
        self.scene.step(now - self.then)
        self.then, at = now, self.scene.robot.time
        clock = self.node.get_clock().now().nanoseconds * 1e-9 - at + self.skew
        if at - self.told >= self.period:
            self.told = at
            self.publish_odometry(clock)
        if at - self.scanned >= SCANS - PERIOD / 2:
            self.scanned = at
            self.publish_scan(clock)
        joint = self.scene.joint()
        if joint is not None:
            self.states.publish(JointState(name=["head_turn", "head_tilt"], position=[math.radians(joint), 0.0]))

    def publish_odometry(self, clock: float) -> None:
        said = self.scene.odometry(clock)
        if said is None:
            return
        message = Odometry()
        message.header.stamp = stamp(said.stamp)
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y = said.x, said.y
        half = math.radians(said.heading) / 2
        pose.orientation.z, pose.orientation.w = said.quaternion * math.sin(half), said.quaternion * math.cos(half)
        twist.linear.x, twist.angular.z = said.speed, math.radians(said.spin)
        message.pose.covariance[0] = said.covariance
        self.odometry.publish(message)

    def publish_scan(self, clock: float) -> None:
        said = self.scene.scan(clock)
        if said is None:
            return
        message = LaserScan(range_min=said.low, range_max=said.high)
        message.header.stamp = stamp(said.stamp)
        message.angle_min, message.angle_increment = math.radians(said.start), math.radians(said.step)
        message.angle_max = message.angle_min + message.angle_increment * (len(said.ranges) - 1)
        message.ranges = said.ranges
        self.scans.publish(message)


if __name__ == "__main__":
    serve("liar", LyingNode)

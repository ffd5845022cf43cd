"""A small robot. `robot.py [PART ...]` with drive, stamped, stuck, scan, battery, arm, services or speech."""

from __future__ import annotations

import math
import sys
import time
from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import BatteryState, JointState, LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectory

from tests.ros.peers.peer import serve, tell

PARTS = set(sys.argv[1:])
PERIOD = 0.02
DEPTH = 1000  # a robot on a busy machine still hears every velocity


class Robot:
    """Integrates velocities, moves its joint, and publishes what it senses."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.x = self.y = self.yaw = 0.0
        self.twist = Twist()
        self.joint, self.target = 0.0, 0.0
        node.declare_parameter("max_speed", 0.5)
        if PARTS & {"drive", "stuck"}:
            node.create_subscription(Twist, "/cmd_vel", self.drive, DEPTH)
        if "stamped" in PARTS:
            node.create_subscription(TwistStamped, "/cmd_vel", lambda m: self.drive(m.twist), DEPTH)
        if "speech" in PARTS:
            node.create_subscription(String, "/speech", lambda m: tell("said", m.data), 10)
        if "arm" in PARTS:
            node.create_subscription(JointTrajectory, "/joint_trajectory", self.move, 10)
        if "services" in PARTS:
            node.create_service(Trigger, "/dock", self.dock)
            node.create_service(Trigger, "/think", self.think)
            node.create_service(SetBool, "/left_hand/close", self.close)
            docked = node.create_publisher(
                Bool, "/docked", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            )
            docked.publish(Bool(data=True))
        self.odometry = node.create_publisher(Odometry, "/odom", 10)
        self.scans = node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data)
        self.batteries = node.create_publisher(BatteryState, "/battery_state", 10)
        self.states = node.create_publisher(JointState, "/joint_states", 10)
        node.create_timer(PERIOD, self.step)

    def drive(self, twist: Twist) -> None:
        if (twist.linear.x, twist.angular.z) == (0.0, 0.0):
            tell("zero", f"{self.x:.2f}", f"{math.degrees(self.yaw):.0f}")
        self.twist = twist

    def move(self, trajectory: JointTrajectory) -> None:
        [name], [point] = trajectory.joint_names, trajectory.points
        self.target = point.positions[0]
        tell("joint", name, f"{self.target:.2f}", point.time_from_start.sec, point.time_from_start.nanosec)

    def dock(self, request: Any, response: Any) -> Any:
        response.success, response.message = False, "the dock is taken"
        return response

    def think(self, request: Any, response: Any) -> Any:
        tell("thinking")
        time.sleep(4.0)
        return response

    def close(self, request: Any, response: Any) -> Any:
        tell("hand", request.data)
        response.success, response.message = True, "cup"
        return response

    def step(self) -> None:
        if "stuck" not in PARTS:
            self.yaw += self.twist.angular.z * PERIOD
            self.x += self.twist.linear.x * math.cos(self.yaw) * PERIOD
            self.y += self.twist.linear.x * math.sin(self.yaw) * PERIOD
        if PARTS & {"drive", "stamped", "stuck"}:
            odometry = Odometry()
            odometry.pose.pose.position.x, odometry.pose.pose.position.y = self.x, self.y
            odometry.pose.pose.orientation.z = math.sin(self.yaw / 2)
            odometry.pose.pose.orientation.w = math.cos(self.yaw / 2)
            self.odometry.publish(odometry)
        if "scan" in PARTS:  # a wall 0.4 m ahead, and something nearer on the left
            ranges = [math.inf] * 360
            ranges[350:], ranges[:10], ranges[85:95] = [0.4] * 10, [0.4] * 10, [0.2] * 10
            scan = LaserScan(angle_min=0.0, angle_increment=math.tau / 360, range_min=0.05, range_max=10.0)
            scan.ranges = ranges
            self.scans.publish(scan)
        if "battery" in PARTS:
            self.batteries.publish(
                BatteryState(percentage=0.25, power_supply_status=BatteryState.POWER_SUPPLY_STATUS_CHARGING)
            )
        if "arm" in PARTS:
            self.joint += max(-0.05, min(0.05, self.target - self.joint))
            self.states.publish(JointState(name=["other", "left_arm_lift"], position=[9.0, self.joint]))


if __name__ == "__main__":
    serve("robot", Robot)

"""A plain robot without a watchdog, whose sensors misbehave as they are told. `faulty_robot.py [FAULT ...]`

It drives at the velocity that it heard last, for ever. A text on /misbehave is a list of faults, which take the place
of those before and put the robot back to where it began:

- `odom=FAULT`: nan, inf, zero (the quaternion), far (1e9 m away), jump (50 m, once), frozen (the pose, not the twist),
  spin (the heading turns 40 degrees with each message), silent; with `@moving` from the first velocity on
- `scan=FAULT`: nan, negative, zero, empty, flat (no angle between the beams), close (-inf), free (+inf), silent,
  absent (from the start: no publisher)
- `battery=FAULT`: nan, high (a percentage of 80), silent, empty (0), blip (0 in one of 25 messages)
- `joint=FAULT`: nan, split (each in a message of its own), half (so, and those of the head no more)
- `docked=FAULT`: volatile (no last message for later listeners), best (effort), silent; without one nobody says it
- `clock=FAULT` of simulated time: backward, standing, slow (a thousandth of real time), twice (one that is 1000 s ahead
  in turn with the right one); with `@moving` from the first velocity on
- `late=SECONDS`: a velocity takes effect so much later

It prints `faults ...` when it has heard of them, `drive LINEAR ANGULAR` for each other velocity, and `not finite`.
"""

from __future__ import annotations

import math
import sys
import time
from typing import Any

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, JointState, LaserScan
from std_msgs.msg import Bool, String
from trajectory_msgs.msg import JointTrajectory

from btlang.ros.messages import stamp
from tests.ros.peers.peer import serve, tell

PERIOD = 0.02
JOINTS = ("left_arm_lift", "left_arm_swing", "left_arm_bend", "head_turn", "head_tilt")
BEAMS = {
    "nan": [math.nan] * 360,
    "negative": [-1.0] * 360,
    "zero": [0.0] * 360,
    "empty": [],
    "close": [-math.inf] * 20 + [math.inf] * 340,
    "free": [math.inf] * 360,
}


class FaultyRobot:
    """Integrates velocities and publishes what it senses, right or wrong."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.faults: dict[str, str] = {}
        self.joints = dict.fromkeys(JOINTS, 0.0)
        self.docked: Any = None
        self.begin(" ".join(sys.argv[1:]))
        node.create_subscription(Twist, "cmd_vel", self.drive, 10)
        node.create_subscription(JointTrajectory, "joint_trajectory", self.move, 10)
        node.create_subscription(String, "misbehave", lambda message: self.begin(message.data), 10)
        self.clock = node.create_publisher(Clock, "/clock", 10)
        self.time, self.samples = 1000.0, 0
        self.odometry = node.create_publisher(Odometry, "odom", 10)
        absent = self.faults.get("scan") == "absent"
        self.scans = None if absent else node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self.batteries = node.create_publisher(BatteryState, "battery_state", 10)
        self.states = node.create_publisher(JointState, "joint_states", 10)
        node.create_timer(PERIOD, self.step)

    def begin(self, faults: str) -> None:
        self.faults = dict(fault.split("=") for fault in faults.split())
        self.x = self.y = self.yaw = 0.0
        self.linear = self.angular = 0.0
        self.last = (0.0, 0.0)
        self.has_moved = False
        self.waiting: list[tuple[float, float, float]] = []
        self.then = time.monotonic()
        if "docked" in self.faults:
            self.publish_docked(self.faults["docked"])
        tell("faults", faults)

    def drive(self, twist: Twist) -> None:
        wanted = twist.linear.x, twist.angular.z
        if not all(map(math.isfinite, wanted)):
            tell("not finite", *wanted)
            return
        if wanted != self.last:
            tell("drive", f"{wanted[0]:.3f}", f"{wanted[1]:.3f}")
        self.last = wanted
        self.has_moved |= wanted != (0.0, 0.0)
        self.waiting.append((time.monotonic() + float(self.faults.get("late", "0")), *wanted))

    def move(self, trajectory: JointTrajectory) -> None:
        for name, position in zip(trajectory.joint_names, trajectory.points[-1].positions, strict=True):
            if not math.isfinite(position):
                tell("not finite", name)
            self.joints[name] = position

    def has(self, sensor: str) -> str:
        fault, _, when = self.faults.get(sensor, "").partition("@")
        return fault if self.has_moved or not when else ""

    def step(self) -> None:
        passed, self.then = time.monotonic() - self.then, time.monotonic()
        while self.waiting and self.waiting[0][0] <= self.then:
            _, self.linear, self.angular = self.waiting.pop(0)
        self.yaw += self.angular * passed
        self.x += self.linear * math.cos(self.yaw) * passed
        self.y += self.linear * math.sin(self.yaw) * passed
        self.publish_clock(self.has("clock"), passed)
        self.publish_odometry(self.has("odom"))
        self.publish_scan(self.has("scan"))
        if self.has("battery") != "silent":
            self.samples += 1
            blip = 0.5 if self.samples % 25 else 0.0
            shares = {"nan": math.nan, "high": 80.0, "empty": 0.0, "blip": blip}
            share = shares.get(self.has("battery"), 0.5)
            self.batteries.publish(BatteryState(percentage=share))
        self.publish_joints(self.has("joint"))

    def publish_clock(self, fault: str, passed: float) -> None:
        self.time += {"backward": -1.0, "standing": 0.0, "slow": 0.001}.get(fault, 1.0) * passed
        self.clock.publish(Clock(clock=stamp(self.time)))
        if fault == "twice":
            self.clock.publish(Clock(clock=stamp(self.time + 1000.0)))

    def publish_docked(self, fault: str) -> None:
        if self.docked is not None:
            self.node.destroy_publisher(self.docked)
        volatile, best = DurabilityPolicy.VOLATILE, ReliabilityPolicy.BEST_EFFORT
        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        if fault != "silent":
            profile = QoSProfile(depth=1, durability=volatile) if fault == "volatile" else qos_profile_sensor_data
            assert fault == "volatile" or profile.reliability == best
        self.docked = self.node.create_publisher(Bool, "docked", profile)

    def publish_joints(self, fault: str) -> None:
        if fault not in ("split", "half"):
            positions = [math.nan if fault else at for at in self.joints.values()]
            self.states.publish(JointState(name=list(self.joints), position=positions))
            return
        for name, at in self.joints.items():
            if fault == "split" or not name.startswith("head"):
                self.states.publish(JointState(name=[name], position=[at]))

    def publish_odometry(self, fault: str) -> None:
        if fault == "silent":
            return
        message = Odometry()
        message.header.stamp = self.node.get_clock().now().to_msg()
        pose, twist = message.pose.pose, message.twist.twist
        if fault == "spin":
            self.yaw += math.radians(40)
        pose.position.x, pose.position.y = self.x, self.y
        pose.orientation.z, pose.orientation.w = math.sin(self.yaw / 2), math.cos(self.yaw / 2)
        twist.linear.x, twist.angular.z = self.linear, self.angular
        if fault in ("nan", "inf"):
            pose.position.x = twist.linear.x = twist.angular.z = float(fault)
        elif fault == "zero":
            pose.orientation.z = pose.orientation.w = 0.0
        elif fault in ("far", "jump"):
            pose.position.x += 1e9 if fault == "far" else 50.0
        elif fault == "frozen":
            pose.position.x = pose.position.y = pose.orientation.z = 0.0
            pose.orientation.w = 1.0
            twist.linear.x = 0.5
        self.odometry.publish(message)

    def publish_scan(self, fault: str) -> None:
        if fault == "silent" or self.scans is None:
            return
        scan = LaserScan(angle_min=0.0, angle_increment=math.tau / 360, range_min=0.05, range_max=10.0)
        scan.ranges = BEAMS.get(fault, [2.0] * 360)
        if fault == "flat":
            scan.angle_increment = 0.0
        self.scans.publish(scan)


if __name__ == "__main__":
    serve("faulty_robot", FaultyRobot)

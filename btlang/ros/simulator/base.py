"""The base of the simulated robot as topics: wheels, odometry, bumper, scanner, and the battery with its dock."""

from __future__ import annotations

from array import array
from math import degrees, isfinite, nan, radians
from time import monotonic

from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import BatteryState, LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

from btlang.robots.geometry import CENTRE
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.scan import as_measured
from btlang.ros.messages import BASE, MAP, ODOM, pose_message
from btlang.ros.node import LATCHED
from btlang.ros.simulator.shared import COMMANDS, CallQueue, LatchedPublisher, Moment, PeriodicPublisher

_SILENCE = 0.5  # simulated seconds without a command after which the robot brakes
_ON_THE_WAY = 0.3  # real seconds for which velocities that were sent before a goal may still arrive
_SCANS = 10


class BaseTopics:
    """The base: /cmd_vel drives it. A goal ends with a command to move; a zero, or silence, leaves it alone."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._driven = self._rolls = False
        self._commanded_at = 0.0
        self._ignored_until = 0.0
        self._odometry = node.create_publisher(Odometry, "odom", COMMANDS)
        self._pose = node.create_publisher(PoseWithCovarianceStamped, "amcl_pose", LATCHED)
        self._bump = node.create_publisher(String, "bump", COMMANDS)
        self._due = PeriodicPublisher(20)
        node.create_subscription(Twist, "cmd_vel", lambda twist: calls.post(lambda: self._drive(twist)), COMMANDS)

    def watch(self) -> None:
        """Brake if commands have ceased. Call this before each step."""
        if self._driven and self._robot.time - self._commanded_at >= _SILENCE - 1e-6:
            self._driven = self._rolls = False
            self._robot.drive(0.0, 0.0)

    @property
    def driven(self) -> bool:
        """Whether commands drive the robot."""
        return self._driven

    def leave(self) -> None:
        """Let a goal drive from now on, even if velocities that were sent before arrive later."""
        if self._rolls:
            self._ignored_until = monotonic() + _ON_THE_WAY
        self._driven = self._rolls = False

    def bumped(self, into: str) -> None:
        """Publish a contact that has just begun."""
        self._bump.publish(String(data=into))

    def publish(self, now: Moment) -> None:
        """Publish where the robot is and how it moves."""
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


class SensorTopics:
    """The sensors, the battery and the dock; a silent scanner publishes nothing."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._scan = node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self._battery = node.create_publisher(BatteryState, "battery_state", COMMANDS)
        self._docked = LatchedPublisher(node, Bool, "docked", robot.docked) if robot.body.dock is not None else None
        self._scan_due, self._battery_due = PeriodicPublisher(_SCANS), PeriodicPublisher(2)

        def dock(request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
            response.success, response.message = calls.ask(robot.dock)
            return response

        def undock(request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
            response.success, response.message = calls.ask(robot.undock)
            return response

        if robot.body.dock is not None:
            node.create_service(Trigger, "dock", dock)
            node.create_service(Trigger, "undock", undock)

    def publish(self, now: Moment) -> None:
        """Publish the readings."""
        if self._docked is not None:
            self._docked.set(self._robot.docked)
        if self._robot.body.battery is not None and self._battery_due.is_due(now.seconds):
            self._publish_battery(now)
        if self._scan_due.is_due(now.seconds):
            self._publish_scan(now)

    def _publish_scan(self, now: Moment) -> None:
        sensor = self._robot.body.sensor("scanner")
        if sensor is None:
            return
        try:
            ranges = self._robot.scan()
        except RobotError:
            return
        ranges = as_measured(ranges, CENTRE if sensor.frame == BASE else sensor.pose)
        step = radians(1)
        scan = LaserScan(angle_min=0.0, angle_max=359 * step, angle_increment=step, scan_time=1 / _SCANS)
        scan.range_min, scan.range_max, scan.ranges = 0.0, sensor.range, array("f", ranges)
        scan.header.stamp, scan.header.frame_id = now.stamp, sensor.frame
        self._scan.publish(scan)

    def _publish_battery(self, now: Moment) -> None:
        robot = self._robot
        battery = BatteryState(percentage=robot.battery / 100, present=True)
        battery.header.stamp = now.stamp
        battery.voltage = battery.current = battery.charge = battery.capacity = battery.temperature = nan
        battery.design_capacity = nan
        if robot.charging:
            battery.power_supply_status = BatteryState.POWER_SUPPLY_STATUS_CHARGING
        elif robot.docked:
            battery.power_supply_status = BatteryState.POWER_SUPPLY_STATUS_FULL
        else:
            battery.power_supply_status = BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
        self._battery.publish(battery)

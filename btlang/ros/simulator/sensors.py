"""The laser scanner, and the battery with its dock: /scan, /battery_state, /docked, /dock, /undock."""

from __future__ import annotations

from array import array
from math import nan, radians

from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import BatteryState, LaserScan
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

from btlang.robots.geometry import CENTRE
from btlang.robots.robot import RobotError
from btlang.robots.scan import as_measured
from btlang.robots.simulated import SimulatedRobot
from btlang.ros.poses import BASE
from btlang.ros.simulator.call_queue import CallQueue
from btlang.ros.simulator.publishing import COMMANDS, Every, Latched, Moment

_SCANS = 10


class Sensors:
    """Publishes what the robot senses; a silent scanner publishes nothing."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._scan = node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self._battery = node.create_publisher(BatteryState, "battery_state", COMMANDS)
        self._docked = Latched(node, Bool, "docked", robot.docked) if robot.body.dock is not None else None
        self._scan_due, self._battery_due = Every(_SCANS), Every(2)

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
        """Publishes what the robot senses."""
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

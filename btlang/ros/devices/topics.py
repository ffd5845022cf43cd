"""The devices of a robot as topics: publishes their readings and takes commands for them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial

from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data

from btlang.devices.device_set import Reads
from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import KINDS, Reading
from btlang.engine.leaves.leaf import described
from btlang.robots.robot import RobotError
from btlang.ros.devices.setting import COMMANDS, Setting, topic_name
from btlang.ros.devices.translations import TRANSLATIONS
from btlang.ros.latest import NodeClock

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.body import Body

_RATES = {"camera": 5.0, "lidar": 10.0, "battery": 2.0}  # messages a second; others come with each call
_COMPLAIN = 5.0  # seconds between two complaints


class ShownDevice:
    """One device: its readings on the topic of its name, its commands on the topic `command` below that."""

    def __init__(self, device: Device, reads: Reads, setting: Setting, node: Node) -> None:
        self._name, self._reads, self._node = device.name, reads, node
        self._translation = TRANSLATIONS[device.kind](setting)
        self._period, self._due = 1.0 / _RATES.get(device.kind, 1e6), 0.0
        self._latest: Reading | None = None
        self._frame = setting.frame
        self._publisher: Any = None
        kind, topic = KINDS[device.kind], topic_name(device.name)
        if kind.reading is not None:
            self._publisher = node.create_publisher(self._translation.reads, topic, qos_profile_sensor_data)
        if kind.command is not None:
            below = f"{topic}/{COMMANDS}" if kind.reading is not None else topic
            node.create_subscription(self._translation.takes, below, self._command, 10)

    def publish(self, stamp: Callable[[], Any]) -> None:
        """Its reading, where it is new, it isn't silent, and somebody listens."""
        now = time.monotonic()
        if self._publisher is None or now < self._due or not self._publisher.get_subscription_count():
            return
        try:
            reading = self._reads.read(self._name)
        except DeviceError:
            return
        if reading is self._latest:
            return
        self._latest, self._due = reading, now + self._period
        message = self._translation.shown(reading)
        if hasattr(message, "header"):
            message.header.stamp = stamp()
            message.header.frame_id = message.header.frame_id or self._frame
        self._publisher.publish(message)

    def _command(self, message: Any) -> None:
        """In the thread that spins."""
        try:
            self._reads.write(self._name, self._translation.command(message))
        except (RobotError, ValueError, IndexError) as problem:
            reason = str(problem) if isinstance(problem, RobotError) else described(problem)
            text = f"a command for the {self._name} was refused: {reason}"
            self._node.get_logger().warning(text, throttle_duration_sec=_COMPLAIN)


class DeviceTopics:
    """Those of a robot, on a node that somebody else spins."""

    def __init__(self, node: Node, devices: Mapping[str, Device], readers: Mapping[str, Reads], body: Body) -> None:
        make = partial(ShownDevice, node=node)
        self._clock = NodeClock(node)
        self._shown = [make(device, readers[name], _setting(device, body)) for name, device in devices.items()]

    def publish(self) -> None:
        """What is new."""
        for device in self._shown:
            device.publish(self._clock.message)


def _setting(device: Device, body: Body) -> Setting:
    joint, scanner = body.joint(device.name), body.sensor("scanner")
    reach = float(device.options.get("range", 0.0)) if device.kind == "range" else body.range
    return Setting(
        topic_name(device.name),
        joint is not None and joint.slides,
        body.base.wheel_gap if body.base is not None else 1.0,
        reach,
        scanner.frame if scanner is not None and device.kind == "lidar" else topic_name(device.name),
    )

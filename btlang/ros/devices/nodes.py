"""The nodes of devices: one that uses topics as devices of a robot, and one that publishes devices as topics."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data

from btlang.devices.device_set import Reads
from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.kinds import KINDS, Command, Reading, Sound
from btlang.devices.loop import SILENCE
from btlang.engine.leaves.leaf import describe_exception
from btlang.robots.robot import RobotError
from btlang.ros.devices.actuators import (
    DisplayTranslation,
    DriveTranslation,
    HandTranslation,
    JointTranslation,
    LightTranslation,
    MicrophoneTranslation,
    SpeakerTranslation,
)
from btlang.ros.devices.sensors import (
    BatteryTranslation,
    ButtonTranslation,
    CameraTranslation,
    ImuTranslation,
    LidarTranslation,
    RangeTranslation,
)
from btlang.ros.devices.setting import COMMANDS, Setting, TopicDevice, topic_name
from btlang.ros.devices.translation import Translation
from btlang.ros.node import LATCHED, SpunNode
from btlang.ros.subscriptions import NodeClock

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body


TRANSLATIONS: dict[str, type[Translation]] = {
    "range": RangeTranslation,
    "lidar": LidarTranslation,
    "drive": DriveTranslation,
    "imu": ImuTranslation,
    "battery": BatteryTranslation,
    "joint": JointTranslation,
    "hand": HandTranslation,
    "camera": CameraTranslation,
    "microphone": MicrophoneTranslation,
    "speaker": SpeakerTranslation,
    "button": ButtonTranslation,
    "light": LightTranslation,
    "display": DisplayTranslation,
}
"""The translations by kind of device."""


_MOST = 50  # messages of one topic that wait for a cycle
_LAST_WORD = 0.1  # seconds that the last command gets to be heard
_RATES = {"camera": 5.0, "lidar": 10.0, "battery": 2.0}  # messages a second; others come with each call
_COMPLAIN = 5.0  # seconds between two complaints


class TopicClient:
    """One device over topics. `arrived` is for the thread that spins, everything else for that of the loop."""

    def __init__(self, device: TopicDevice, node: Node) -> None:
        self._device, self._kind = device, KINDS[device.kind]
        self._translation = TRANSLATIONS[device.kind](device.setting)
        self._messages: deque[tuple[Any, float]] = deque(maxlen=_MOST)
        self._latest: tuple[Reading | None, float] = None, -math.inf
        self._given, self._refused = -math.inf, ""
        self._sent: Command | None = None
        self._publisher: Any = None
        if device.topic:
            node.create_subscription(self._translation.reads, device.topic, self.on_message, qos_profile_sensor_data)
        if device.command:
            qos = 10 if self._kind.reading is not None else LATCHED  # who listens later gets what a light shows
            self._publisher = node.create_publisher(self._translation.takes, device.command, qos)

    def on_message(self, message: Any) -> None:
        """Take a message."""
        self._messages.append((message, time.monotonic()))

    def send(self, command: Command | None) -> None:
        """Publish a command: in each cycle if the device moves, else once. Raises RobotError."""
        if command is None or (command is self._sent and not self._kind.moves):
            return
        self._sent = command
        self._publisher.publish(self._translation.sent(command))

    def rest(self) -> None:
        """Bring the device to rest if it moves."""
        if self._kind.rest is not None:
            self.send(self._kind.rest)

    def reading(self) -> Reading | DeviceError | None:
        """Return the latest reading; None if it is old. One that can't be true counts as silence."""
        if not self._device.topic:
            heard = self._publisher.get_subscription_count()
            return Reading() if heard else DeviceSilent(f"nobody listens to {self._device.command}")
        samples = []
        while self._messages:
            message, arrival = self._messages.popleft()
            self._refused, reading = self._read(message)
            if reading is not None:
                self._latest = reading, arrival
            if isinstance(reading, Sound):
                samples.append(reading.samples)
        found, arrival = self._latest
        age = time.monotonic() - arrival
        if found is None or age > self._device.silence:
            return DeviceSilent(self._refused or f"nothing arrives on {self._device.topic}")
        if age > max(0.0, self._device.silence - SILENCE) and arrival <= self._given:
            return None  # the loop counts on
        self._given = arrival
        return Sound(b"".join(samples), found.rate) if isinstance(found, Sound) else found

    def _read(self, message: Any) -> tuple[str, Reading | None]:
        """Return the reading in a message, or the reason why there is none."""
        try:
            return "", self._translation.reading(message)
        except DeviceError as problem:
            return f"{self._device.topic}: {problem}", None
        except (ValueError, OverflowError, IndexError) as problem:
            return f"{self._device.topic} can't be understood: {describe_exception(problem)}", None


class DeviceClient:
    """The node for all devices of a robot that are topics. Raises MissionError (BT100) if ROS 2 doesn't start."""

    def __init__(self, devices: Sequence[TopicDevice]) -> None:
        self._spun = SpunNode("btlang_devices")
        try:
            self._clients = {device.name: TopicClient(device, self._spun.node) for device in devices}
            self._spun.start()
        except BaseException:
            self._spun.close()
            raise

    def exchange(self, commands: Mapping[str, Command]) -> dict[str, Reading | DeviceError]:
        readings: dict[str, Reading | DeviceError] = {}
        for name, client in self._clients.items():
            reading = client.reading()
            if reading is not None:
                readings[name] = reading
            try:
                client.send(commands.get(name))
            except RobotError as problem:
                readings[name] = DeviceError(str(problem))
        return readings

    def close(self) -> None:
        """Bring all devices to rest, and leave the ROS graph."""
        for client in self._clients.values():
            client.rest()
        time.sleep(_LAST_WORD)
        self._spun.close()


class ShownDevice:
    """One device as topics: readings on the topic of its name, commands on `command` below it."""

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
        """Publish the reading if it is new and somebody listens."""
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
        """Write a command, in the thread that spins."""
        try:
            self._reads.write(self._name, self._translation.command(message))
        except (RobotError, ValueError, IndexError) as problem:
            reason = str(problem) if isinstance(problem, RobotError) else describe_exception(problem)
            text = f"a command for the {self._name} was refused: {reason}"
            self._node.get_logger().warning(text, throttle_duration_sec=_COMPLAIN)


class DeviceTopics:
    """Topics for the devices of a robot. The caller spins the node."""

    def __init__(self, node: Node, devices: Mapping[str, Device], readers: Mapping[str, Reads], body: Body) -> None:
        make = partial(ShownDevice, node=node)
        self._clock = NodeClock(node)
        self._shown = [make(device, readers[name], _make_setting(device, body)) for name, device in devices.items()]

    def publish(self) -> None:
        """Publish all new readings."""
        for device in self._shown:
            device.publish(self._clock.message)


def _make_setting(device: Device, body: Body) -> Setting:
    joint, scanner = body.joint(device.name), body.sensor("scanner")
    reach = float(device.options.get("range", 0.0)) if device.kind == "range" else body.range
    return Setting(
        topic_name(device.name),
        joint is not None and joint.slides,
        body.base.wheel_gap if body.base is not None else 1.0,
        reach,
        scanner.frame if scanner is not None and device.kind == "lidar" else topic_name(device.name),
    )

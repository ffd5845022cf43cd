"""The node behind the driver `topic`: hears readings, and publishes commands."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Mapping, Sequence

from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data

from btlang.devices.driver import DeviceError, DeviceSilent
from btlang.devices.kinds import KINDS, Command, Reading, Sound
from btlang.devices.loop import SILENCE
from btlang.engine.leaves.leaf import described
from btlang.robots.robot import RobotError
from btlang.ros.devices.setting import TopicDevice
from btlang.ros.devices.translations import TRANSLATIONS
from btlang.ros.node import LATCHED, SpunNode
from btlang.ros.times import seconds_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 50  # messages of one topic that wait for a cycle
_OLD = 1.0  # seconds that a message may be later than the fastest one
_LAST_WORD = 0.1  # seconds that the last command gets to be heard


class Freshness:
    """Whether messages are news, by their stamps: the clock of their computer may be another one than ours."""

    def __init__(self) -> None:
        self._before, self._least = -math.inf, math.inf

    def fault(self, message: Any) -> str:
        """Why a message is none, to be read behind its name; "" where it is."""
        header = getattr(message, "header", None)
        stamp = seconds_of(header.stamp) if header is not None else 0.0
        if stamp == 0.0:
            return ""
        behind, before, self._before = time.monotonic() - stamp, self._before, stamp
        if stamp < before:  # its clock was set, or it restarted: what follows counts
            self._least = math.inf
            return "sends an older message than before"
        if stamp == before:
            return "sends the same message again"
        self._least = min(self._least, behind)
        late = behind - self._least
        return f"sends messages that are {late:.1f} s old" if late > _OLD else ""


class TopicClient:
    """One device. `arrived` is for the thread that spins, all else for that of the loop."""

    def __init__(self, device: TopicDevice, node: Node) -> None:
        self._device, self._kind = device, KINDS[device.kind]
        self._translation = TRANSLATIONS[device.kind](device.setting)
        self._freshness = Freshness()
        self._messages: deque[tuple[Any, float]] = deque(maxlen=_MOST)
        self._latest: tuple[Reading | None, float] = None, -math.inf
        self._given, self._refused = -math.inf, ""
        self._sent: Command | None = None
        self._publisher: Any = None
        if device.topic:
            node.create_subscription(self._translation.reads, device.topic, self.arrived, qos_profile_sensor_data)
        if device.command:
            qos = 10 if self._kind.reading is not None else LATCHED  # who listens later gets what a light shows
            self._publisher = node.create_publisher(self._translation.takes, device.command, qos)

    def arrived(self, message: Any) -> None:
        """A message has come."""
        self._messages.append((message, time.monotonic()))

    def send(self, command: Command | None) -> None:
        """Publishes a command: in each cycle if the device moves, else once. Raises RobotError."""
        if command is None or (command is self._sent and not self._kind.moves):
            return
        self._sent = command
        self._publisher.publish(self._translation.sent(command))

    def rest(self) -> None:
        """Brings to rest what moves."""
        if self._kind.rest is not None:
            self.send(self._kind.rest)

    def reading(self) -> Reading | DeviceError | None:
        """Its latest reading; None where that is old, and soon silence. One that can't be true is silence too."""
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
        """The reading of a message, or why there is none."""
        fault = self._freshness.fault(message) if self._translation.concerns(message) else ""
        if fault:
            return f"{self._device.topic} {fault}", None
        try:
            return "", self._translation.reading(message)
        except DeviceError as problem:
            return f"{self._device.topic}: {problem}", None
        except (ValueError, OverflowError, IndexError) as problem:
            return f"{self._device.topic} can't be understood: {described(problem)}", None


class DeviceClient:
    """All devices of a robot that are topics. Raises MissionError (BT100) where ROS 2 doesn't start."""

    def __init__(self, devices: Sequence[TopicDevice]) -> None:
        self._spun = SpunNode("btlang_devices")
        try:
            self._clients = {device.name: TopicClient(device, self._spun.node) for device in devices}
            self._spun.start()
        except BaseException:
            self._spun.close()
            raise

    def exchange(self, commands: Mapping[str, Command]) -> dict[str, Reading | DeviceError]:
        """See btlang.devices.driver.Driver."""
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
        """Brings to rest what moves, and leaves the ROS graph."""
        for client in self._clients.values():
            client.rest()
        time.sleep(_LAST_WORD)
        self._spun.close()

"""The driver `topic`: devices that are topics of ROS 2. Imports no ROS before it is opened."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import KINDS, Command, Reading
from btlang.devices.loop import SILENCE
from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.motion.guard.guard import FRESH
from btlang.ros.available import require_ros
from btlang.ros.devices.setting import COMMANDS, Setting, TopicDevice, topic_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.ros.devices.nodes import DeviceClient

PACKAGES = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "trajectory_msgs")
"""The packages of messages that devices are in."""
_SLOW = 2.0  # seconds without a message after which what doesn't move is silent
_OF_KINDS = {"drive": ("wheel_gap",), "joint": ("joint", "slides"), "hand": ("joint",), "range": (), "lidar": ()}


class TopicDriver:
    """The driver `topic`, whose devices all share one node.

    Options of all kinds: `topic`, by default the name of the device, `command` (by default the topic with /command
    appended) and `silence` in seconds. Of a drive: `wheel_gap` in metres. Of a joint: `joint`, its name in messages,
    and `slides`.
    """

    kinds: Sequence[str] = tuple(KINDS)
    needs_port = False

    def __init__(self, port: str, devices: Sequence[Device]) -> None:
        self.rate = 30.0
        self._devices = [_topic_device(device) for device in devices]
        self._client: DeviceClient | None = None

    def open(self) -> None:
        """Implement Driver. Raises DeviceError."""
        try:
            require_ros(*PACKAGES)
            from btlang.ros.devices.nodes import DeviceClient

            self._client = DeviceClient(self._devices)
        except MissionError as problem:
            arguments = dict(problem.diagnostics[0].arguments)
            raise DeviceError(f"ROS 2 can't be used: {arguments['reason']}. {arguments['advice']}".strip()) from None

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        assert self._client is not None
        return self._client.exchange(commands)

    def close(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            client.close()


def _topic_device(device: Device) -> TopicDevice:
    """Read the options of a device. Raises DeviceError for ones that can't be used."""
    kind, options = KINDS[device.kind], dict(device.options)
    topic = _text(device, options, "topic", f"/{topic_name(device.name)}")
    usual = f"{topic}/{COMMANDS}" if kind.reading is not None else topic
    command = _text(device, options, COMMANDS, usual) if kind.command is not None else ""
    silence = _number(device, options, "silence", _usual_silence(device.kind), SILENCE)
    gap = _number(device, options, "wheel_gap", 0.0, 0.01) if device.kind == "drive" else 0.0
    own = _OF_KINDS.get(device.kind, ())
    joint = _text(device, options, "joint", topic_name(device.name)) if "joint" in own else ""
    slides = bool(options.pop("slides", False)) if "slides" in own else False
    if device.kind == "drive" and not gap:
        raise DeviceError(f'the {device.name} needs its "wheel_gap" in metres, such as options = {{ wheel_gap = 0.3 }}')
    for name in options:
        known = ", ".join(("topic", COMMANDS, "silence", *own))
        raise DeviceError(f'unknown option "{name}" of the {device.name}; it has {known}')
    reads = topic if kind.reading is not None else ""
    return TopicDevice(device.name, device.kind, reads, command, silence, Setting(joint, slides, gap))


def _usual_silence(kind: str) -> float:
    """Return the seconds after which a device is silent: fewer for one that moves or that the guard uses."""
    return SILENCE if KINDS[kind].moves else FRESH if kind in ("lidar", "range") else _SLOW


def _text(device: Device, options: dict[str, Any], name: str, usual: str) -> str:
    value = options.pop(name, usual)
    if not isinstance(value, str) or not value.replace("/", "").replace("_", "").isalnum() or not value.isascii():
        raise DeviceError(f'the option "{name}" of the {device.name} must be a name of ROS 2, such as "{usual}"')
    return value


def _number(device: Device, options: dict[str, Any], name: str, usual: float, low: float) -> float:
    value = options.pop(name, usual)
    if isinstance(value, bool) or not isinstance(value, int | float) or (value != usual and not low <= value <= 1e6):
        raise DeviceError(f'the option "{name}" of the {device.name} must be a number from {low:g}')
    return float(value)

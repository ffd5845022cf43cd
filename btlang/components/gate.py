"""Devices as components get them: what moves takes no command while the robot is stopped."""

from __future__ import annotations

from btlang.devices.device_set import Reads
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import KINDS, Command, Reading

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Gate:
    """See btlang.devices.device_set.Reads. A device that moves and isn't commanded again comes to rest by itself."""

    def __init__(self, devices: Reads, kind: str, robot: Any) -> None:
        self._devices, self._rest, self._robot = devices, KINDS[kind].rest, robot

    def read(self, name: str) -> Reading:
        """The latest reading. Raises DeviceSilent."""
        return self._devices.read(name)

    def write(self, name: str, command: Command) -> None:
        """Raises DeviceError while the robot is stopped, or for what the device doesn't take."""
        if self._rest is not None and command != self._rest and self._robot.refuses:
            raise DeviceError(f"the {name} isn't moved: the robot is stopped")
        self._devices.write(name, command)

    def silent(self, name: str) -> str | None:
        """Why it is silent."""
        return self._devices.silent(name)

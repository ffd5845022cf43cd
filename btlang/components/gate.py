"""Devices as components get them: what moves takes no command while the robot is stopped."""

from __future__ import annotations

from btlang.devices.device_set import Reads
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import KINDS, Command, Reading

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Gate:
    """See btlang.devices.device_set.Reads. A device that moves and isn't told again comes to rest by itself."""

    def __init__(self, devices: Reads, kind: str, robot: Any) -> None:
        self._devices, self._kind, self._robot = devices, KINDS[kind], robot

    def read(self, name: str) -> Reading:
        """The latest reading. Raises DeviceSilent."""
        return self._devices.read(name)

    def write(self, name: str, command: Command) -> None:
        """Raises DeviceError while the robot is stopped, or for what the device doesn't take."""
        rest = self._kind.command
        if self._kind.moves and self._robot.refuses and (rest is None or command != rest()):
            raise DeviceError(f"the {name} isn't moved: the robot is stopped")
        self._devices.write(name, command)

    def silent(self, name: str) -> str | None:
        """Why it is silent."""
        return self._devices.silent(name)

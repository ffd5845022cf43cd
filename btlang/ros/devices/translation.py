"""The base of all translations between messages and the readings and commands of one device."""

from __future__ import annotations

from math import isnan

from btlang.devices.driver import DeviceError, DeviceSilent
from btlang.devices.kinds import Command, Reading
from btlang.ros.devices.setting import Setting
from btlang.ros.subscriptions import MessageGate

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MEASURES_NOTHING, _TAKES_NOTHING = "it measures nothing", "it takes no commands"


class Translation:
    """Messages from readings and commands of one device, and back.

    `reads` and `takes` are the classes of messages for readings and commands. If one is None, the device has none, and
    the methods that make them raise DeviceError.
    """

    reads: Any = None
    takes: Any = None

    def __init__(self, setting: Setting) -> None:
        self._setting = setting
        self._gate = MessageGate(self.reads, all_stamps=True)

    def concerns(self, message: Any) -> bool:
        """Return whether a message is about this device: others may share its topic."""
        return True

    def reading(self, message: Any) -> Reading:
        """Return the reading in a message. Raises DeviceSilent if it can't be true."""
        reason = self._gate.refuses(message) if self.concerns(message) else ""
        if reason:
            raise DeviceSilent(f"it {reason}")
        return self._read(message)

    def _read(self, message: Any) -> Reading:
        raise DeviceError(_MEASURES_NOTHING)

    def shown(self, reading: Any) -> Any:
        """Return the message for a reading."""
        raise DeviceError(_MEASURES_NOTHING)

    def sent(self, command: Any) -> Any:
        """Return the message for a command. Raises RobotError if it is beyond the limits."""
        raise DeviceError(_TAKES_NOTHING)

    def command(self, message: Any) -> Command:
        """Return the command in a message. Raises DeviceError."""
        raise DeviceError(_TAKES_NOTHING)


def number(value: float, what: str) -> float:
    """Return a number in a message. Raises DeviceSilent if it isn't a number."""
    if isnan(value):
        raise DeviceSilent(f"its {what} is not a number")
    return float(value)

"""What a driver is: one port with the devices on it, behind one small protocol."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from btlang.devices.kinds import Command, Reading
from btlang.robots.bodies.body import Device
from btlang.robots.robot import RobotError, SensorSilent

__all__ = ["Device", "DeviceError", "DeviceSilent", "Driver", "MakesDriver"]


class DeviceError(RobotError):
    """Why a device or a port can't be used, in plain English."""


class DeviceSilent(DeviceError, SensorSilent):
    """A device reports nothing, or nothing that can be true, so its reading is unknown."""


class Driver(Protocol):
    """The devices of one port. It is used by one thread, that of its loop, and made with the port, the devices on it,
    and its own options of the robot file; that opens nothing yet."""

    rate: float
    """Cycles a second that it asks for; `open` may change it."""

    def open(self) -> None:
        """Finds the devices. Raises DeviceError where that can't be done now; it is tried again later."""

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        """One cycle: sends all devices their commands and returns their new readings, both by name.

        A device without a new reading since the last cycle is left out; if its reading can't be used, an error takes
        the reading's place. A device that measures nothing, such as a light, answers with an empty `Reading()`. The
        method waits only for the port, at most a tenth of a second. Raises DeviceError when the port is lost: then the
        port is closed and opened again.
        """

    def close(self) -> None:
        """Brings to rest what moves, as far as the port can still be reached, and lets go of it. May be called twice,
        and of a driver that isn't open."""


class MakesDriver(Protocol):
    """A class of drivers. `kinds` are those that it can drive; `needs_port`, whether a device has to name a port."""

    kinds: Sequence[str]
    needs_port: bool

    def __call__(self, port: str, devices: Sequence[Device]) -> Driver:
        """A driver, not opened yet. Raises DeviceError for options that it can't use, naming the device."""

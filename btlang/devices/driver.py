"""What a driver is: one port with the devices on it, behind one small protocol; and which drivers there are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from btlang.devices.kinds import Command, Reading
from btlang.engine.leaves.leaf import describe_exception
from btlang.robots.bodies.body import Device
from btlang.robots.files import module_of
from btlang.robots.robot import RobotError, SensorSilent

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


__all__ = ["Device", "DeviceError", "DeviceSilent", "Driver", "MakesDriver"]
SIMULATED = "simulated"
DRIVERS = {
    "serial-board": "btlang.devices.serial_board.driver:SerialBoard",
    "camera": "btlang.devices.media:Camera",
    "sound": "btlang.devices.media:SoundCard",
    "dynamixel": "btlang.devices.dynamixel.driver:DynamixelDriver",
    "topic": "btlang.ros.devices.driver:TopicDriver",
}
"""The classes of drivers by name. SIMULATED devices have none, since they act in the world of the simulated robot."""
ENTRY_POINTS = "btlang.drivers"


class DeviceError(RobotError):
    """The reason why a device or a port can't be used, in plain English."""


class DeviceSilent(DeviceError, SensorSilent):
    """The error that a device reports nothing, or nothing that can be true, so its reading is unknown."""


class Driver(Protocol):
    """The devices of one port, used only by the thread of its loop.

    It is made with the port, the devices on it, and its own options of the robot file; that opens nothing yet.
    """

    rate: float
    """Cycles a second that it asks for; `open` may change it."""

    def open(self) -> None:
        """Find the devices. Raises DeviceError if that can't be done now; it is tried again later."""

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        """Do one cycle: send all devices their commands and return their new readings, both by name.

        A device without a new reading since the last cycle is left out; if its reading can't be used, an error takes
        the reading's place. A device that measures nothing, such as a light, answers with an empty `Reading()`. The
        method waits only for the port, at most a tenth of a second. Raises DeviceError when the port is lost: then the
        port is closed and opened again.
        """

    def close(self) -> None:
        """Bring to rest what moves, as far as the port can still be reached, and close it.

        May be called twice, and for a driver that isn't open.
        """


class MakesDriver(Protocol):
    """A class of drivers. `kinds` are those that it can drive; `needs_port` is whether a device has to name a port."""

    kinds: Sequence[str]
    needs_port: bool

    def __call__(self, port: str, devices: Sequence[Device]) -> Driver:
        """Return a driver that isn't open yet. Raises DeviceError for unusable options, naming the device."""


def driver_class(name: str, folder: str = "") -> MakesDriver:
    """Return a driver class: one of DRIVERS, an entry point of the group `btlang.drivers`, or `module:Class`.

    Raises DeviceError.
    """
    place = DRIVERS.get(name, name)
    if ":" not in place:
        from importlib.metadata import entry_points

        places = [entry_point.value for entry_point in entry_points(group=ENTRY_POINTS, name=name)]
        if not places:
            listed = ", ".join((SIMULATED, *DRIVERS))
            raise DeviceError(f'there is no driver "{name}"; the drivers are {listed}, or write module:Class')
        place = places[0]
    module, _, attribute = place.partition(":")
    try:
        found: Any = getattr(module_of(module, "" if name in DRIVERS else folder), attribute)
    except Exception as problem:  # whatever somebody's module raises
        raise DeviceError(f'the driver "{name}" can\'t be loaded: {problem}') from problem
    lacks = next(
        (each for each in ("kinds", "needs_port", "open", "exchange", "close") if not hasattr(found, each)), ""
    )
    if not isinstance(found, type) or lacks:
        raise DeviceError(f'"{name}" isn\'t a class of drivers' + (f": it has no {lacks}" if lacks else ""))
    return found  # type: ignore[return-value]


def make_driver(name: str, folder: str, port: str, devices: Sequence[Device]) -> Driver:
    """Return a driver that isn't open yet. Raises DeviceError, whatever its constructor raises."""
    kind = driver_class(name, folder)
    try:
        return kind(port, devices)
    except DeviceError:
        raise
    except Exception as problem:
        raise DeviceError(f'the driver "{name}" can\'t be made: {describe_exception(problem)}') from problem

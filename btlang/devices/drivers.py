"""Which drivers there are: by name, or as `module:Class` of somebody else."""

from __future__ import annotations

from btlang.devices.driver import DeviceError
from btlang.engine.leaves.leaf import described
from btlang.robots.files import module_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from btlang.devices.driver import Device, Driver, MakesDriver

SIMULATED = "simulated"
DRIVERS = {
    "serial-board": "btlang.devices.serial_board.driver:SerialBoard",
    "camera": "btlang.devices.media.camera:Camera",
    "sound": "btlang.devices.media.sound:SoundCard",
    "dynamixel": "btlang.devices.dynamixel.driver:DynamixelDriver",
    "topic": "btlang.ros.devices.driver:TopicDriver",
}
"""Places of the classes; SIMULATED devices have none, since they act in the world of the simulated robot."""
ENTRY_POINTS = "btlang.drivers"


def driver_class(name: str, folder: str = "") -> MakesDriver:
    """The class of a driver: one of DRIVERS, an entry point of the group `btlang.drivers`, or `module:Class`.

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
    """A driver, not opened yet. Raises DeviceError, whatever its constructor raises."""
    kind = driver_class(name, folder)
    try:
        return kind(port, devices)
    except DeviceError:
        raise
    except Exception as problem:
        raise DeviceError(f'the driver "{name}" can\'t be made: {described(problem)}') from problem

"""Which drivers there are: by name, or as `module:Class` of somebody else."""

from __future__ import annotations

import sys
from importlib import import_module

from btlang.devices.driver import DeviceError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.devices.driver import MakesDriver

SIMULATED = "simulated"
DRIVERS = {
    "serial-board": "btlang.devices.serial_board.driver:SerialBoard",
    "camera": "btlang.devices.media.camera:Camera",
    "sound": "btlang.devices.media.sound:SoundCard",
    "dynamixel": "btlang.devices.dynamixel.driver:DynamixelDriver",
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
    if folder and folder not in sys.path and name not in DRIVERS:
        sys.path.insert(0, folder)
    try:
        found: Any = getattr(import_module(module), attribute)
    except Exception as problem:  # whatever somebody's module raises
        raise DeviceError(f'the driver "{name}" can\'t be loaded: {problem}') from problem
    return found  # type: ignore[no-any-return]

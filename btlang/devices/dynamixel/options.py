"""What a robot file says of a servo."""

from __future__ import annotations

import math
from collections.abc import Sequence

from btlang.devices.driver import Device, DeviceError
from btlang.devices.dynamixel.protocol import HIGHEST_ID
from btlang.support.record import Record

_HIGHEST_BAUD = 4_500_000


class ServoOptions(Record):
    """`hottest` is in degrees Celsius, `low` and `high` are limits in true degrees; None leaves them to the servo.
    `baud` is that of the port: all servos on it have the same."""

    id: int
    reverse: bool = False
    at_end: str = "hold"
    hottest: float | None = None
    low: float | None = None
    high: float | None = None
    baud: int = 1_000_000


def read_options(device: Device) -> ServoOptions:
    """Those of one servo. Raises DeviceError for one that can't be used."""
    options = dict(device.options)
    names = ServoOptions.fields
    unknown = sorted(map(str, options.keys() - set(names)))
    if unknown:
        raise DeviceError(f"the {device.name}: a Dynamixel servo has no option '{unknown[0]}', but {', '.join(names)}")
    if "id" not in options:
        raise DeviceError(f"the {device.name}: the option 'id' is missing, the number of the servo on its port")
    read = ServoOptions(**options)
    for name, is_right, wanted in (
        ("id", _is_whole(read.id, 0, HIGHEST_ID), f"a whole number from 0 to {HIGHEST_ID}"),
        ("reverse", isinstance(read.reverse, bool), "true or false"),
        ("at_end", read.at_end in ("hold", "loose"), "'hold' or 'loose'"),
        ("hottest", _is_number(read.hottest), "degrees Celsius"),
        ("low", _is_number(read.low), "degrees"),
        ("high", _is_number(read.high), "degrees"),
        ("baud", _is_whole(read.baud, 9_600, _HIGHEST_BAUD), f"a whole number from 9600 to {_HIGHEST_BAUD}"),
    ):
        if not is_right:
            raise DeviceError(f"the {device.name}: {name} is {getattr(read, name)!r}; it has to be {wanted}")
    if read.low is not None and read.high is not None and read.low >= read.high:
        raise DeviceError(f"the {device.name}: low is {read.low:g}; it has to be less than high, {read.high:g}")
    return read


def read_all(devices: Sequence[Device]) -> list[ServoOptions]:
    """Those of the servos on a port. Raises DeviceError where they contradict each other."""
    read = [read_options(device) for device in devices]
    users: dict[int, str] = {}
    for device, options in zip(devices, read, strict=True):
        other = users.setdefault(options.id, device.name)
        if other != device.name:
            raise DeviceError(f"the {other} and the {device.name} have the same id {options.id} on {device.port}")
        if options.baud != read[0].baud:
            bauds = f"{read[0].baud} for the {devices[0].name} and {options.baud} for the {device.name}"
            raise DeviceError(f"the port {device.port} has one baud, but the options say {bauds}")
    return read


def _is_whole(value: object, low: int, high: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def _is_number(value: object) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value))

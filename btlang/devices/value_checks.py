"""What in a reading or a command can't be used, whatever made it: drivers and components are by other people."""

from __future__ import annotations

from functools import cache
from math import fsum, isfinite, isnan

from btlang.devices.driver import DeviceError
from btlang.devices.kinds import KINDS, Command, Distance, Image, Reading, Scan

_NUMBERS, _NO_NUMBER, _NOT_FINITE = ("float", "int"), "not a number", "not finite"


def wrong_field(record: Reading | Command) -> tuple[str, str] | None:
    """The name of the first field that isn't a number where it has to be one, and what is wrong with it. Distances may
    be infinite.
    """
    for name, may_lack in _number_fields(type(record)):
        value = getattr(record, name)
        if value is None and may_lack:
            continue
        try:
            if isnan(value):
                return name, _NO_NUMBER
        except (TypeError, OverflowError):  # OverflowError: a whole number of hundreds of digits
            return name, _NO_NUMBER
        if not isfinite(value) and not isinstance(record, Distance):
            return name, _NOT_FINITE
    return None


def check_command(name: str, kind: str, command: Command) -> None:
    """Raises DeviceError for a command that a device of this name and kind doesn't take."""
    wanted = KINDS[kind].command
    if wanted is None or not isinstance(command, wanted):
        raise DeviceError(f"the {name} doesn't take a {type(command).__name__}")
    if wrong := wrong_field(command):
        raise DeviceError(f"the {name} doesn't take a {wrong[0]} that is {wrong[1]}")


def wrong_content(reading: Reading) -> str:
    """Why the beams of a scan or the pixels of a picture can't be used, "" where they can."""
    if isinstance(reading, Scan):
        try:
            all_invalid = isnan(fsum(reading.ranges)) and all(map(isnan, reading.ranges))
        except (TypeError, ValueError):  # ValueError: infinity of both signs
            return "its ranges have what is not a number"
        return "its scan has no valid beam" if all_invalid else ""
    if isinstance(reading, Image):
        size, wanted = len(reading.pixels), 3 * reading.width * reading.height
        if reading.width <= 0 or size != wanted:
            return f"its picture has {size} bytes, not {wanted}: 3 for each of {reading.width} by {reading.height}"
    return ""


@cache
def _number_fields(kind: type[Reading | Command]) -> tuple[tuple[str, bool], ...]:
    """The fields that are numbers, and whether each may be None."""
    kinds = ((name, str(kind.__annotations__.get(name, "")).split(" | ")) for name in kind.fields)
    return tuple((name, "None" in each) for name, each in kinds if each[0] in _NUMBERS)

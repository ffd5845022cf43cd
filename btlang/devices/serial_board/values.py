"""Readings and commands of each kind as integers of fixed width, little-endian: the values in messages of a board."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from struct import Struct
from typing import Any

from btlang.devices.driver import DeviceError
from btlang.devices.kinds import (
    Charge,
    Colour,
    Command,
    Distance,
    JointState,
    JointTarget,
    Motion,
    Pressed,
    Reading,
    Shown,
    Wheels,
    WheelSpeeds,
)
from btlang.support.record import Record

KIND_NUMBERS = {
    "range": 1, "drive": 2, "imu": 3, "battery": 4, "button": 5, "joint": 6, "light": 7, "display": 8,
}  # fmt: skip
"""The kinds that a board can have."""
TEXT = 32
"""Bytes of the text on a display."""
_U8, _U16, _I8, _I16, _I32 = (0, 0xFF), (0, 0xFFFF), (-0x80, 0x7F), (-0x8000, 0x7FFF), (-(2**31), 2**31 - 1)
_LOOSE, _GOES = 1, 2  # bits of a joint
_UNKNOWN = 2  # whether a battery is charging


class Tally:
    """A 32-bit counter of a board without its jumps: it goes on past the end of the bits, and where the board started
    again it goes on from where it was."""

    def __init__(self) -> None:
        self._total = 0
        self._last: int | None = None

    def count(self, value: int) -> int:
        """What was counted since the first value."""
        if self._last is not None:
            self._total += (value - self._last + 2**31) % 2**32 - 2**31
        self._last = value
        return self._total

    def restart(self) -> None:
        """The next value is the first of a board that started again."""
        self._last = None


class ReadingFormat(Record):
    """How a kind's readings are written: their struct, the integers of a reading, and a reading of those.

    `tallies` are two for each device: its counters. Raises DeviceError for values that can't be true.
    """

    layout: Struct
    integers: Callable[[Any], tuple[int, ...]]
    reading: Callable[[tuple[int, ...], Sequence[Tally]], Reading]


class CommandFormat(Record):
    """How a kind's commands are written. Packing raises DeviceError for what isn't a number."""

    layout: Struct
    pack: Callable[[Any], bytes]
    unpack: Callable[[bytes], Command]


def _integer(value: float | None, unit: float, limits: tuple[int, int], nothing: int = 0) -> int:
    if value is None:
        return nothing
    if not math.isfinite(value):
        raise DeviceError(f"{value} is not a number that a board understands")
    low, high = limits
    return max(low, min(high, round(value / unit)))


def _known(value: int, share: int, nothing: int) -> float | None:
    return None if value == nothing else value / share


def _distance(values: tuple[int, ...], tallies: Sequence[Tally]) -> Distance:
    return Distance(math.inf if values[0] == _U16[1] else values[0] / 1000)


def _distance_integers(reading: Distance) -> tuple[int, ...]:
    return (_U16[1] if reading.distance == math.inf else _integer(reading.distance, 0.001, (0, _U16[1] - 1)),)


def _wheels(values: tuple[int, ...], tallies: Sequence[Tally]) -> Wheels:
    left, right = (tally.count(value) / 10_000 for tally, value in zip(tallies, values, strict=False))
    return Wheels(left, right, values[2] / 1000, values[3] / 1000)


def _wheels_integers(reading: Wheels) -> tuple[int, ...]:
    ticks = [(round(metres / 0.0001) + 2**31) % 2**32 - 2**31 for metres in (reading.left, reading.right)]
    return (*ticks, *(_integer(speed, 0.001, _I16) for speed in (reading.left_speed, reading.right_speed)))


def _motion(values: tuple[int, ...], tallies: Sequence[Tally]) -> Motion:
    turning, *pushes, heading = values
    ahead, left, up = (_known(push, 100, _I16[0]) for push in pushes)
    known = None if heading == _I32[0] else tallies[0].count(heading) / 100
    return Motion(turning / 100, ahead, left, up, known)


def _motion_integers(reading: Motion) -> tuple[int, ...]:
    pushes = (_integer(push, 0.01, _I16, _I16[0]) for push in (reading.ahead, reading.left, reading.up))
    return (_integer(reading.turning, 0.01, _I32), *pushes, _integer(reading.heading, 0.01, _I32, _I32[0]))


def _charge(values: tuple[int, ...], tallies: Sequence[Tally]) -> Charge:
    percent, volts, amperes, temperature, charging = values
    if percent > 10_000 or charging > _UNKNOWN:
        raise DeviceError(f"it says {percent / 100} percent, charging {charging}, which can't be true")
    return Charge(
        percent / 100,
        _known(volts, 1000, _U16[1]),
        _known(amperes, 100, _I16[0]),
        _known(temperature, 10, _I16[0]),
        None if charging == _UNKNOWN else charging == 1,
    )


def _charge_integers(reading: Charge) -> tuple[int, ...]:
    return (
        _integer(reading.percent, 0.01, (0, 10_000)),
        _integer(reading.volts, 0.001, _U16, _U16[1]),
        _integer(reading.amperes, 0.01, _I16, _I16[0]),
        _integer(reading.temperature, 0.1, _I16, _I16[0]),
        _UNKNOWN if reading.charging is None else int(reading.charging),
    )


def _pressed(values: tuple[int, ...], tallies: Sequence[Tally]) -> Pressed:
    if values[0] > 1:
        raise DeviceError(f"it says {values[0]}; a button is 0 or 1")
    return Pressed(values[0] == 1)


def _joint(values: tuple[int, ...], tallies: Sequence[Tally]) -> JointState:
    position, speed, load, temperature, loose = values
    if loose > _LOOSE:
        raise DeviceError(f"its torque is {loose}; it is 0 (on) or 1 (off)")
    warmth = _known(temperature, 1, _I8[0])
    return JointState(position / 100, speed / 10, _known(load, 1, _I8[0]), warmth, loose == _LOOSE)


def _joint_integers(state: JointState) -> tuple[int, ...]:
    load, temperature = (_integer(value, 1.0, _I8, _I8[0]) for value in (state.load, state.temperature))
    return (_integer(state.position, 0.01, _I32), _integer(state.speed, 0.1, _I16), load, temperature, int(state.loose))


READINGS = {
    "range": ReadingFormat(Struct("<H"), _distance_integers, _distance),
    "drive": ReadingFormat(Struct("<iihh"), _wheels_integers, _wheels),
    "imu": ReadingFormat(Struct("<ihhhi"), _motion_integers, _motion),
    "battery": ReadingFormat(Struct("<HHhhB"), _charge_integers, _charge),
    "button": ReadingFormat(Struct("<B"), lambda reading: (int(reading.pressed),), _pressed),
    "joint": ReadingFormat(Struct("<ihbbB"), _joint_integers, _joint),
}
"""By kind; the other kinds measure nothing."""


_SPEEDS, _TARGET, _COLOUR, _SHOWN = Struct("<hh"), Struct("<BiH"), Struct("<BBB"), Struct(f"<{TEXT}s")


def _pack_speeds(command: WheelSpeeds) -> bytes:
    return _SPEEDS.pack(_integer(command.left, 0.001, _I16), _integer(command.right, 0.001, _I16))


def _unpack_speeds(data: bytes) -> WheelSpeeds:
    left, right = _SPEEDS.unpack(data)
    return WheelSpeeds(left / 1000, right / 1000)


def _pack_target(command: JointTarget) -> bytes:
    flags = _LOOSE * command.loose | _GOES * (command.position is not None)
    return _TARGET.pack(flags, _integer(command.position, 0.01, _I32), _integer(command.speed, 0.1, _U16, _U16[1]))


def _unpack_target(data: bytes) -> JointTarget:
    flags, position, speed = _TARGET.unpack(data)
    return JointTarget(position / 100 if flags & _GOES else None, _known(speed, 10, _U16[1]), bool(flags & _LOOSE))


def _pack_colour(command: Colour) -> bytes:
    return _COLOUR.pack(*(_integer(part, 1 / 255, _U8) for part in (command.red, command.green, command.blue)))


def _unpack_colour(data: bytes) -> Colour:
    return Colour(*(part / 255 for part in data))


def _pack_shown(command: Shown) -> bytes:
    whole = command.text.encode("utf-8", "replace")[:TEXT].decode("utf-8", "ignore")  # no half character at the end
    return _SHOWN.pack(whole.encode())


def _unpack_shown(data: bytes) -> Shown:
    return Shown(data.rstrip(b"\0").decode("utf-8", "replace"))


COMMANDS = {
    "drive": CommandFormat(_SPEEDS, _pack_speeds, _unpack_speeds),
    "joint": CommandFormat(_TARGET, _pack_target, _unpack_target),
    "light": CommandFormat(_COLOUR, _pack_colour, _unpack_colour),
    "display": CommandFormat(_SHOWN, _pack_shown, _unpack_shown),
}
"""By kind; the other kinds take no commands."""

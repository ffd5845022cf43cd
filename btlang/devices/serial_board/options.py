"""The options of a board and its devices, from the robot file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from btlang.devices.driver import Device, DeviceError
from btlang.support.record import Record

_SEARCHED = "board "
_BOARD = {"baud": 115_200, "rate": 50.0, "board": ""}
_CHANNEL = ("channel", "frozen")


class BoardOptions(Record):
    """The board: its name ("" where any will do), and either a path or that all ports are searched for it."""

    name: str
    path: str
    baud: int
    rate: float

    @property
    def searched(self) -> bool:
        """Whether its port has to be found."""
        return not self.path


class ChannelOptions(Record):
    """A device: its number on the board, and seconds after which a value that is exactly the same isn't believed."""

    channel: int
    frozen: float | None


def read_options(port: str, devices: Sequence[Device]) -> tuple[BoardOptions, Mapping[str, ChannelOptions]]:
    """The options of a board, which any of its devices may have, and of its devices by name. Raises DeviceError."""
    board: dict[str, Any] = {}
    channels: dict[str, ChannelOptions] = {}
    for device in devices:
        unknown = [option for option in device.options if option not in (*_BOARD, *_CHANNEL)]
        if unknown:
            known = ", ".join((*_CHANNEL, *_BOARD))
            raise DeviceError(f"the {device.name} has an unknown option '{unknown[0]}'. Known: {known}")
        channels[device.name] = _channel(device)
        for option, value in device.options.items():
            if option in _BOARD and board.setdefault(option, value) != value:
                raise DeviceError(
                    f"the {device.name} says {option} {value}, another device of its board {board[option]}"
                )
    numbers: dict[int, str] = {}
    for name, options in channels.items():
        if numbers.setdefault(options.channel, name) != name:
            raise DeviceError(f"the {name} and the {numbers[options.channel]} have the same channel {options.channel}")
    return _board(port, {**_BOARD, **board}), channels


def _channel(device: Device) -> ChannelOptions:
    channel, frozen = device.options.get("channel"), device.options.get("frozen")
    if type(channel) is not int or not 0 <= channel <= 255:
        raise DeviceError(f"the {device.name} needs its number on the board, 0 to 255. Write for example: channel = 1")
    if frozen is not None and (type(frozen) not in (int, float) or not 0 < frozen < float("inf")):
        raise DeviceError(f"the {device.name} has frozen = {frozen}; it takes seconds, for example 2.5")
    return ChannelOptions(channel, frozen)


def _board(port: str, options: Mapping[str, Any]) -> BoardOptions:
    baud, rate, name = options["baud"], options["rate"], options["board"]
    if type(baud) is not int or not 1200 <= baud <= 20_000_000:
        raise DeviceError(f"baud = {baud} at {port}; it takes a whole number, for example 115200")
    if type(rate) not in (int, float) or not 12.5 <= rate <= 500:
        raise DeviceError(f"rate = {rate} at {port}; it takes cycles a second from 12.5 to 500, for example 50")
    if not isinstance(name, str):
        raise DeviceError(f"board = {name} at {port}; it takes the name of a board in quotes")
    searched = port.removeprefix(_SEARCHED).strip() if port.startswith(_SEARCHED) else ""
    if not port.strip() or port.strip() == _SEARCHED.strip():
        raise DeviceError('a board needs its port: a path as "/dev/ttyUSB0", or "board" and its name as "board base"')
    if name and searched and name != searched:
        raise DeviceError(f"board = {name}, but the port says '{port}'")
    return BoardOptions(searched or name, "" if searched else port, baud, float(rate))

"""The messages between a computer and its board, and the values in them; docs/serial-board.md has every byte."""

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
"""The numbers of the kinds that a board can have."""
TEXT = 32
"""Bytes of the text on a display."""
_U8, _U16, _I8, _I16, _I32 = (0, 0xFF), (0, 0xFFFF), (-0x80, 0x7F), (-0x8000, 0x7FFF), (-(2**31), 2**31 - 1)
_LOOSE, _GOES = 1, 2  # bits of a joint
_UNKNOWN = 2  # whether a battery is charging
_SPEEDS, _TARGET, _COLOUR, _SHOWN = Struct("<hh"), Struct("<BiH"), Struct("<BBB"), Struct(f"<{TEXT}s")
VERSION = 1
"""The version of the protocol."""
ASK_HELLO, TELL, STOP = 0x01, 0x02, 0x03
"""Types of messages to a board."""
HELLO, ANSWER = 0x81, 0x82
"""Types of messages of a board."""
KINDS_BY_NUMBER = {number: kind for kind, number in KIND_NUMBERS.items()}
_ASK_HELLO, _TELL = Struct("<BBH"), Struct("<BHH")
_HELLO, _ANSWER = Struct("<HH"), Struct("<BHHI")
_CHANNEL, _READING, _COMMAND = Struct("<BBH"), Struct("<BBB"), Struct("<BB")


class UnwrappedCounter:
    """A 32-bit counter of a board without its jumps: it goes on beyond the last bit, and after
    a restart of the board.
    """

    def __init__(self) -> None:
        self._total = 0
        self._last: int | None = None

    def count(self, value: int) -> int:
        """Return what was counted since the first value."""
        if self._last is not None:
            self._total += (value - self._last + 2**31) % 2**32 - 2**31
        self._last = value
        return self._total

    def restart(self) -> None:
        """Restart: the next value is the first of a board that started again."""
        self._last = None


class ReadingFormat(Record):
    """The format of a kind's readings: their struct, the integers of a reading, and a reading of those.

    `tallies` are two for each device: its counters. Raises DeviceError for values that can't be true.
    """

    layout: Struct
    integers: Callable[[Any], tuple[int, ...]]
    reading: Callable[[tuple[int, ...], Sequence[UnwrappedCounter]], Reading]


class CommandFormat(Record):
    """The format of a kind's commands. Packing raises DeviceError for values that aren't numbers."""

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


def _distance(values: tuple[int, ...], tallies: Sequence[UnwrappedCounter]) -> Distance:
    return Distance(math.inf if values[0] == _U16[1] else values[0] / 1000)


def _distance_integers(reading: Distance) -> tuple[int, ...]:
    return (_U16[1] if reading.distance == math.inf else _integer(reading.distance, 0.001, (0, _U16[1] - 1)),)


def _wheels(values: tuple[int, ...], tallies: Sequence[UnwrappedCounter]) -> Wheels:
    left, right = (tally.count(value) / 10_000 for tally, value in zip(tallies, values, strict=False))
    return Wheels(left, right, values[2] / 1000, values[3] / 1000)


def _wheels_integers(reading: Wheels) -> tuple[int, ...]:
    ticks = [(round(metres / 0.0001) + 2**31) % 2**32 - 2**31 for metres in (reading.left, reading.right)]
    return (*ticks, *(_integer(speed, 0.001, _I16) for speed in (reading.left_speed, reading.right_speed)))


def _motion(values: tuple[int, ...], tallies: Sequence[UnwrappedCounter]) -> Motion:
    turning, *pushes, heading = values
    ahead, left, up = (_known(push, 100, _I16[0]) for push in pushes)
    known = None if heading == _I32[0] else tallies[0].count(heading) / 100
    return Motion(turning / 100, ahead, left, up, known)


def _motion_integers(reading: Motion) -> tuple[int, ...]:
    pushes = (_integer(push, 0.01, _I16, _I16[0]) for push in (reading.ahead, reading.left, reading.up))
    return (_integer(reading.turning, 0.01, _I32), *pushes, _integer(reading.heading, 0.01, _I32, _I32[0]))


def _charge(values: tuple[int, ...], tallies: Sequence[UnwrappedCounter]) -> Charge:
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


def _pressed(values: tuple[int, ...], tallies: Sequence[UnwrappedCounter]) -> Pressed:
    if values[0] > 1:
        raise DeviceError(f"it says {values[0]}; a button is 0 or 1")
    return Pressed(values[0] == 1)


def _joint(values: tuple[int, ...], tallies: Sequence[UnwrappedCounter]) -> JointState:
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
"""The formats of readings by kind; the other kinds measure nothing."""


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
"""The formats of commands by kind; the other kinds take no commands."""


class BoardChannel(Record):
    """A device of a board by its number there, with the seconds between two of its samples at most."""

    number: int
    kind: str
    interval: float


class Hello(Record):
    """Who a board is.

    `session` is that of the computer which it obeys, `before` the one before that; 0: none since it was started.
    """

    version: int
    name: str
    session: int = 0
    before: int = 0
    channels: tuple[BoardChannel, ...] = ()


class BoardSample(Record):
    """A channel's part of an answer: `count` goes up by one with each sample."""

    number: int
    kind: str
    count: int
    integers: tuple[int, ...]


class BoardAnswer(Record):
    """A board's samples of all channels that measure something.

    `sequence` is that of the message it answers, `milliseconds` the time since it was started, in 32 bits.
    """

    session: int
    sequence: int
    milliseconds: int
    samples: tuple[BoardSample, ...]


class BoardCommands(Record):
    """Commands to a board: the number and kind of each channel, and the bytes of its command."""

    session: int
    sequence: int
    commands: tuple[tuple[int, str, bytes], ...]


def ask_hello(session: int) -> bytes:
    """Return a message that asks a board who it is, and begins a session with it; 0 only asks."""
    return _ASK_HELLO.pack(ASK_HELLO, VERSION, session)


def read_ask_hello(message: bytes) -> tuple[int, int] | None:
    """Return the version and the session in such a message."""
    if len(message) != _ASK_HELLO.size:
        return None
    _, version, session = _ASK_HELLO.unpack(message)
    return version, session


def hello_message(hello: Hello) -> bytes:
    """Return the message in which a board says who it is."""
    name = hello.name.encode()
    channels = b"".join(
        _CHANNEL.pack(channel.number, KIND_NUMBERS[channel.kind], round(channel.interval * 1000))
        for channel in hello.channels
    )
    head = bytes([HELLO, hello.version, len(name)]) + name
    return head + _HELLO.pack(hello.session, hello.before) + channels


def read_hello(message: bytes) -> Hello | None:
    """Return the hello in a message, None if it isn't one. For another version of the protocol, only version and name
    are read.
    """
    if len(message) < 3 or message[0] != HELLO or len(message) < 3 + message[2]:
        return None
    version, at = message[1], 3 + message[2]
    name = "".join(c if c.isprintable() else "?" for c in message[3:at].decode("utf-8", "replace"))
    if version != VERSION:
        return Hello(version, name)
    if len(message) < at + _HELLO.size or (len(message) - at - _HELLO.size) % _CHANNEL.size:
        return None
    session, before = _HELLO.unpack_from(message, at)
    channels = tuple(
        BoardChannel(number, KINDS_BY_NUMBER.get(kind, f"kind {kind}"), interval / 1000)
        for number, kind, interval in _CHANNEL.iter_unpack(message[at + _HELLO.size :])
    )
    return Hello(version, name, session, before, channels)


def command_message(message: BoardCommands) -> bytes:
    """Return the message with commands to a board; without any it is a heartbeat."""
    commands = b"".join(_COMMAND.pack(number, KIND_NUMBERS[kind]) + data for number, kind, data in message.commands)
    return _TELL.pack(TELL, message.session, message.sequence) + commands


def read_command_head(message: bytes) -> tuple[int, int] | None:
    """Return the session and the sequence of a message with commands."""
    if len(message) < _TELL.size:
        return None
    _, session, sequence = _TELL.unpack_from(message)
    return session, sequence


def read_commands(message: bytes) -> tuple[tuple[int, str, bytes], ...] | None:
    """Return the commands in a message, None if they can't be read to their end."""
    commands, at = [], _TELL.size
    while at < len(message):
        kind = KINDS_BY_NUMBER.get(message[at + 1], "") if at + 1 < len(message) else ""
        if kind not in COMMANDS:
            return None
        end = at + _COMMAND.size + COMMANDS[kind].layout.size
        if end > len(message):
            return None
        commands.append((message[at], kind, message[at + _COMMAND.size : end]))
        at = end
    return tuple(commands)


def answer_message(answer: BoardAnswer) -> bytes:
    """Return the message with a board's samples."""
    samples = b"".join(
        _READING.pack(sample.number, KIND_NUMBERS[sample.kind], sample.count)
        + READINGS[sample.kind].layout.pack(*sample.integers)
        for sample in answer.samples
    )
    return _ANSWER.pack(ANSWER, answer.session, answer.sequence, answer.milliseconds) + samples


def read_answer(message: bytes) -> BoardAnswer | None:
    """Return the answer in a message, None if it isn't one, or can't be read to its end."""
    if len(message) < _ANSWER.size or message[0] != ANSWER:
        return None
    _, session, sequence, milliseconds = _ANSWER.unpack_from(message)
    samples, at = [], _ANSWER.size
    while at < len(message):
        kind = KINDS_BY_NUMBER.get(message[at + 1], "") if at + _READING.size <= len(message) else ""
        if kind not in READINGS:
            return None
        layout, start = READINGS[kind].layout, at + _READING.size
        if start + layout.size > len(message):
            return None
        samples.append(BoardSample(message[at], kind, message[at + 2], layout.unpack_from(message, start)))
        at = start + layout.size
    return BoardAnswer(session, sequence, milliseconds, tuple(samples))


def command_size(kinds: Sequence[str]) -> int:
    """Return the bytes of a message with commands for channels of these kinds."""
    return _TELL.size + sum(_COMMAND.size + COMMANDS[kind].layout.size for kind in kinds)


def answer_size(channels: Sequence[BoardChannel]) -> int:
    """Return the bytes of an answer of these channels."""
    sizes = [_READING.size + READINGS[channel.kind].layout.size for channel in channels if channel.kind in READINGS]
    return _ANSWER.size + sum(sizes)

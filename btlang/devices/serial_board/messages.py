"""The messages between a computer and its board; docs/serial-board.md has every byte of them."""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct

from btlang.devices.serial_board.values import COMMANDS, KIND_NUMBERS, READINGS
from btlang.support.record import Record

VERSION = 1
"""Of the protocol."""
ASK_HELLO, TELL, STOP = 0x01, 0x02, 0x03
"""Types of messages to a board."""
HELLO, ANSWER = 0x81, 0x82
"""Types of messages of a board."""
KINDS_BY_NUMBER = {number: kind for kind, number in KIND_NUMBERS.items()}
_ASK_HELLO, _TELL = Struct("<BBH"), Struct("<BHH")
_HELLO, _ANSWER = Struct("<HH"), Struct("<BHHI")
_CHANNEL, _READING, _COMMAND = Struct("<BBH"), Struct("<BBB"), Struct("<BB")


class Channel(Record):
    """A device of a board by its number there, with the seconds between two of its samples at most."""

    number: int
    kind: str
    interval: float


class Hello(Record):
    """Who a board is. `session` is that of the computer which it obeys, `before` the one before that; 0: none since it
    was started."""

    version: int
    name: str
    session: int = 0
    before: int = 0
    channels: tuple[Channel, ...] = ()


class Sample(Record):
    """A channel's part of an answer: `count` goes up by one with each sample."""

    number: int
    kind: str
    count: int
    integers: tuple[int, ...]


class Answer(Record):
    """A board's samples of all channels that measure something. `sequence` is that of the message it answers,
    `milliseconds` the time since it was started, in 32 bits."""

    session: int
    sequence: int
    milliseconds: int
    samples: tuple[Sample, ...]


class Commands(Record):
    """Commands to a board: the number and kind of each channel, and the bytes of its command."""

    session: int
    sequence: int
    commands: tuple[tuple[int, str, bytes], ...]


def ask_hello(session: int) -> bytes:
    """Asks a board who it is, and begins a session with it; 0 only asks."""
    return _ASK_HELLO.pack(ASK_HELLO, VERSION, session)


def read_ask_hello(message: bytes) -> tuple[int, int] | None:
    """Version and session."""
    if len(message) != _ASK_HELLO.size:
        return None
    _, version, session = _ASK_HELLO.unpack(message)
    return version, session


def hello_message(hello: Hello) -> bytes:
    """A board says who it is."""
    name = hello.name.encode()
    channels = b"".join(
        _CHANNEL.pack(channel.number, KIND_NUMBERS[channel.kind], round(channel.interval * 1000))
        for channel in hello.channels
    )
    head = bytes([HELLO, hello.version, len(name)]) + name
    return head + _HELLO.pack(hello.session, hello.before) + channels


def read_hello(message: bytes) -> Hello | None:
    """None where it is none. Of another version of the protocol it reads version and name alone."""
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
        Channel(number, KINDS_BY_NUMBER.get(kind, f"kind {kind}"), interval / 1000)
        for number, kind, interval in _CHANNEL.iter_unpack(message[at + _HELLO.size :])
    )
    return Hello(version, name, session, before, channels)


def command_message(message: Commands) -> bytes:
    """The message with commands to a board; without any it is a heartbeat."""
    commands = b"".join(_COMMAND.pack(number, KIND_NUMBERS[kind]) + data for number, kind, data in message.commands)
    return _TELL.pack(TELL, message.session, message.sequence) + commands


def read_command_head(message: bytes) -> tuple[int, int] | None:
    """Session and sequence."""
    if len(message) < _TELL.size:
        return None
    _, session, sequence = _TELL.unpack_from(message)
    return session, sequence


def read_commands(message: bytes) -> tuple[tuple[int, str, bytes], ...] | None:
    """None where they can't be read to their end."""
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


def answer_message(answer: Answer) -> bytes:
    """The message with a board's samples."""
    samples = b"".join(
        _READING.pack(sample.number, KIND_NUMBERS[sample.kind], sample.count)
        + READINGS[sample.kind].layout.pack(*sample.integers)
        for sample in answer.samples
    )
    return _ANSWER.pack(ANSWER, answer.session, answer.sequence, answer.milliseconds) + samples


def read_answer(message: bytes) -> Answer | None:
    """None where it is none, or can't be read to its end."""
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
        samples.append(Sample(message[at], kind, message[at + 2], layout.unpack_from(message, start)))
        at = start + layout.size
    return Answer(session, sequence, milliseconds, tuple(samples))


def command_size(kinds: Sequence[str]) -> int:
    """Bytes of a message with commands for channels of these kinds."""
    return _TELL.size + sum(_COMMAND.size + COMMANDS[kind].layout.size for kind in kinds)


def answer_size(channels: Sequence[Channel]) -> int:
    """Bytes of an answer of these channels."""
    sizes = [_READING.size + READINGS[channel.kind].layout.size for channel in channels if channel.kind in READINGS]
    return _ANSWER.size + sum(sizes)

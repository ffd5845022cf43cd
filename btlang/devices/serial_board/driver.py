"""The driver of boards: asks one for its readings at each cycle, and believes only what can be true."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.kinds import KINDS, Command, Reading
from btlang.devices.loop import SILENCE
from btlang.devices.serial_board.line import FRAMING, MOST_MESSAGE, BoardLine, begin_session, find_board
from btlang.devices.serial_board.messages import (
    COMMANDS,
    KIND_NUMBERS,
    READINGS,
    BoardAnswer,
    BoardChannel,
    BoardCommands,
    UnwrappedCounter,
    answer_size,
    command_message,
    command_size,
    read_answer,
)
from btlang.support.record import Record

_SEARCHED = "board "
_BOARD = {"baud": 115_200, "rate": 50.0, "board": ""}
_CHANNEL = ("channel", "frozen")
_SHARE = 0.8  # of what a line carries that is used
_SLOWEST = 12.5  # cycles a second, so that a board that moves hears a few before it stops alone
_PATIENCE = 1 / _SLOWEST  # seconds that one cycle waits at most
_OLD = 0.1  # seconds after which an answer isn't used any more
_LOST = 0.5  # seconds without an answer after which the port is opened again
_FROZEN_SAMPLES, _FROZEN = 3, 0.15  # intervals, and seconds at least, without a new sample
_BITS = 10  # of each byte on the line


class BoardOptions(Record):
    """The board: its name ("" for any), and either a path or that all ports are searched for it."""

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
    """Return the options of a board, which any of its devices may have, and of its devices by name.

    Raises DeviceError.
    """
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


class _Sent(Record):
    """A message that waits for its answer: when it was sent, and the commands in it that are only sent once."""

    time: float
    kept: Mapping[str, bytes]


class _Known(Record):
    """A device's last sample: since when its samples have been counted, and since when its value has been the same."""

    count: int
    counted: float
    moved: bool
    integers: tuple[int, ...]
    changed: float


class SerialBoard:
    """The driver `serial-board`."""

    kinds: Sequence[str] = tuple(KIND_NUMBERS)
    needs_port = True

    def __init__(self, port: str, devices: Sequence[Device]) -> None:
        self._devices = {device.name: device for device in devices}
        self._options: Mapping[str, ChannelOptions]
        self._board: BoardOptions
        self._board, self._options = read_options(port, devices)
        self.rate = self._board.rate
        self._line: BoardLine | None = None
        self._tallies = {device.name: (UnwrappedCounter(), UnwrappedCounter()) for device in devices}
        self._session = self._sequence = 0
        self._name = ""
        self._begin((), 0.0)

    def open(self) -> None:
        """Implement Driver. The port is a path, or `board NAME`: then all serial ports are asked for it."""
        wanted = self._board
        self._line = find_board(wanted.name, wanted.baud) if wanted.searched else BoardLine(wanted.path, wanted.baud)
        hello = begin_session(self._line)
        if wanted.name and hello.name != wanted.name:
            raise DeviceError(f"the board at {self._line.path} is '{hello.name}', not '{wanted.name}'")
        if hello.before == 0 or hello.before != self._session:  # it was started again, or served somebody else
            for tally in (tally for tallies in self._tallies.values() for tally in tallies):
                tally.restart()
        self._session, self._name = hello.session, hello.name
        self._begin(hello.channels, time.monotonic())
        moving = command_size([device.kind for device in self._devices.values() if KINDS[device.kind].moves])
        if moving > MOST_MESSAGE:
            raise DeviceError(
                f"the board '{hello.name}' has too many motors: a message has {MOST_MESSAGE} bytes at most"
            )
        size = moving + answer_size(hello.channels) + 2 * FRAMING
        carried = wanted.baud / _BITS * _SHARE / size
        if carried < _SLOWEST:
            raise DeviceError(
                f"the line is too slow: {size} bytes a cycle at {wanted.baud} baud are {carried:.1f} cycles a second, "
                f"and it takes {_SLOWEST:g}"
            )
        self.rate = min(wanted.rate, carried)
        self._patience = _PATIENCE

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        line = self._line
        if line is None:
            raise DeviceError("the port is not open")
        refused = self._send(line, commands)
        readings: dict[str, Reading | DeviceError] = {}
        until = time.monotonic() + self._patience
        while True:
            for message in line.receive(until):
                readings |= self._take(message)
            if self._sequence not in self._sent:  # it is answered; answers to those before may come first
                return readings | refused
            now = time.monotonic()
            if now - self._answered > _LOST:
                raise DeviceError(f"the board '{self._name}' at {line.path} doesn't answer")
            if now >= until:
                self._patience = min(_PATIENCE, 2 * self._patience)
                return readings | refused

    def close(self) -> None:
        line, self._line = self._line, None
        if line is not None:
            line.stop()
            line.close()

    def _begin(self, channels: tuple[BoardChannel, ...], now: float) -> None:
        """Reset everything that belongs to one session."""
        self._sent: dict[int, _Sent] = {}
        self._kept: dict[str, bytes] = {}
        self._known: dict[str, _Known] = {}
        self._answered = now
        self._milliseconds: int | None = None
        self._patience = _PATIENCE
        self._measuring = tuple(channel for channel in channels if channel.kind in READINGS)
        kinds = {channel.number: channel.kind for channel in channels}
        self._unusable: dict[str, DeviceError] = {}
        for name, device in self._devices.items():
            number = self._options[name].channel
            if kinds.get(number) != device.kind:
                found = f"is of the kind {kinds[number]}, not {device.kind}" if number in kinds else "doesn't exist"
                self._unusable[name] = DeviceSilent(f"its channel {number} of the board '{self._name}' {found}")
        users = [name for name in self._devices if name not in self._unusable]
        users.sort(key=lambda name: not KINDS[self._devices[name].kind].moves)  # these always have room in a message
        self._users = {self._options[name].channel: name for name in users}

    def _send(self, line: BoardLine, commands: Mapping[str, Command]) -> dict[str, DeviceError]:
        """Send the commands; return the devices that can't be used now.

        What moves rests unless an answer is sure to have come lately.
        """
        now = time.monotonic()
        blind = now + self._patience - self._answered > SILENCE
        kinds: list[str] = []
        packed, kept, refused = [], {}, dict(self._unusable)
        for number, name in self._users.items():
            kind = self._devices[name].kind
            if name not in commands:
                continue
            rest = type(commands[name])()
            try:
                data = COMMANDS[kind].pack(rest if blind and KINDS[kind].moves else commands[name])
            except DeviceError as problem:
                refused[name] = problem
                data = COMMANDS[kind].pack(rest)
            if not KINDS[kind].moves:
                if self._kept.get(name) == data or command_size([*kinds, kind]) > MOST_MESSAGE:
                    continue
                kept[name] = data
            kinds.append(kind)
            packed.append((number, kind, data))
        self._sequence = (self._sequence + 1) % 2**16
        self._sent = {number: sent for number, sent in self._sent.items() if now - sent.time <= _OLD}
        self._sent[self._sequence] = _Sent(now, kept)
        line.send(command_message(BoardCommands(self._session, self._sequence, tuple(packed))))
        return refused

    def _take(self, message: bytes) -> dict[str, Reading | DeviceError]:
        """Return the readings in an answer; none if the answer can't be used."""
        answer, now = read_answer(message), time.monotonic()
        if answer is None:
            return {}
        if answer.session != self._session:
            what = "was started again" if answer.session == 0 else "serves another computer"
            raise DeviceError(f"the board '{self._name}' {what}")
        sent = self._sent.pop(answer.sequence, None)
        if sent is None or now - sent.time > _OLD or len(answer.samples) != len(self._measuring):
            return {}
        last, self._milliseconds = self._milliseconds, answer.milliseconds
        if last is not None and (answer.milliseconds - last) % 2**32 >= 2**31:
            raise DeviceError(f"the time of the board '{self._name}' goes back")
        self._patience = min(_PATIENCE, max(1 / self.rate, 3 * (now - sent.time)))
        self._kept |= sent.kept
        self._answered = now
        return self._read(answer, now)

    def _read(self, answer: BoardAnswer, now: float) -> dict[str, Reading | DeviceError]:
        kinds = {name: KINDS[self._devices[name].kind] for name in self._users.values()}
        readings: dict[str, Reading | DeviceError] = {
            name: Reading() for name, kind in kinds.items() if kind.reading is None
        }
        claims = Counter(sample.number for sample in answer.samples)
        for channel, sample in zip(self._measuring, answer.samples, strict=True):
            name = self._users.get(channel.number)
            if name is None:
                continue
            try:
                if claims[channel.number] > 1:
                    raise DeviceSilent(f"two channels answer with its number {channel.number}")
                if (sample.number, sample.kind) != (channel.number, channel.kind):
                    said = f"channel {sample.number} of the kind {sample.kind}"
                    raise DeviceSilent(f"its channel {channel.number} answers as {said}")
                known = self._counted(name, sample.count, sample.integers, now)
                self._check_age(name, channel, known, now)
                if known.moved:
                    readings[name] = READINGS[channel.kind].reading(sample.integers, self._tallies[name])
            except DeviceError as problem:
                readings[name] = problem
        return readings

    def _counted(self, name: str, count: int, integers: tuple[int, ...], now: float) -> _Known:
        last = self._known.get(name)
        if last is None:
            known = _Known(count, now, False, integers, now)
        else:
            new, same = count != last.count, integers == last.integers
            known = _Known(
                count, now if new else last.counted, last.moved or new, integers, last.changed if same else now
            )
        self._known[name] = known
        return known

    def _check_age(self, name: str, channel: BoardChannel, known: _Known, now: float) -> None:
        place = f"its channel {channel.number} of the board '{self._name}'"
        if now - known.counted > max(_FROZEN, _FROZEN_SAMPLES * channel.interval):
            raise DeviceSilent(f"{place} measures nothing new")
        most = self._options[name].frozen
        if most is not None and now - known.changed > most:
            raise DeviceSilent(f"{place} has had exactly the same value for {most:g} s")

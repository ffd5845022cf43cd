"""A simulated board, which does byte for byte what the firmware does, and a serial line with faults."""

from __future__ import annotations

import os
import pty
import select
import sys
import threading
import time
import tty
from collections.abc import Iterable
from contextlib import suppress
from random import Random
from types import TracebackType
from typing import Protocol

from btlang.devices.kinds import (
    KINDS,
    Charge,
    Command,
    Distance,
    JointState,
    JointTarget,
    Motion,
    Pressed,
    Reading,
    Wheels,
    WheelSpeeds,
)
from btlang.devices.serial_board.line import FrameReader, encode_frame
from btlang.devices.serial_board.messages import (
    ASK_HELLO,
    COMMANDS,
    READINGS,
    STOP,
    TELL,
    VERSION,
    BoardAnswer,
    BoardChannel,
    BoardSample,
    Hello,
    answer_message,
    hello_message,
    read_ask_hello,
    read_command_head,
    read_commands,
)
from btlang.text.output import show

_TURN = 0.002  # seconds between two turns of the board
_BITS = 10
SILENCE = 0.18
"""Seconds without a command after which a channel comes to rest: everything is at rest in 0.2 s."""
CHANNELS = (
    BoardChannel(1, "range", 0.05),
    BoardChannel(2, "drive", 0.02),
    BoardChannel(3, "imu", 0.02),
    BoardChannel(4, "battery", 0.5),
    BoardChannel(5, "button", 0.02),
    BoardChannel(6, "joint", 0.02),
    BoardChannel(7, "light", 0.0),
    BoardChannel(8, "display", 0.0),
)
"""One channel of each kind."""
_FIRST: dict[str, Reading] = {
    "range": Distance(1.0),
    "drive": Wheels(0.0, 0.0, 0.0, 0.0),
    "imu": Motion(0.0, 0.0, 0.0, 9.81, 0.0),
    "battery": Charge(80.0, 12.0, -1.0, 25.0, False),
    "button": Pressed(False),
    "joint": JointState(0.0, 0.0, 10.0, 30.0),
}
_JOINT_SPEED = 90.0  # degrees a second


class BoardModel(Protocol):
    """The board at the end of a line; times are seconds of one clock."""

    def receive(self, data: bytes, now: float) -> bytes:
        """Return the answer to bytes."""

    def turn(self, now: float) -> None:
        """Go on to a time."""

    def reset(self, now: float) -> None:
        """Restart the board."""

    @property
    def speeds(self) -> tuple[float, float]:
        """The metres a second of its wheels."""


class SimulatedLine:
    """A board on a pty at `path`, as a context manager.

    Its faults can be changed at any time: `flipped`: the share of bytes that change on their way; `baud`: bits a second
    that it carries (0: no limit); `echo`: what is sent comes back too; `cut`: the share of answers that are cut in
    half; `deaf`: nothing reaches the board; `noise`: what comes in addition, at each turn; `still_since`: when the
    wheels came to rest, None while they turn.
    """

    def __init__(self, board: BoardModel, seed: int = 0) -> None:
        self.board = board
        self.flipped = self.cut = 0.0
        self.baud = 0
        self.echo = self.deaf = False
        self.noise = b""
        self.still_since: float | None = time.monotonic()
        self.path = ""
        self._master = self._slave = -1
        self._random = Random(seed)
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, name="btlang simulated line", daemon=True)
        with self._lock:
            self.board.reset(time.monotonic())

    def __enter__(self) -> SimulatedLine:
        self.plug()
        self._thread.start()
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._over.set()
        self._thread.join()
        self.unplug()
        os.close(self._slave)

    def plug(self) -> None:
        """Connect the cable, which gets another path than before."""
        master, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        with self._lock:
            before, self._slave = self._slave, slave
            self.path, self._master = os.ttyname(slave), master
        if before >= 0:
            os.close(before)

    def unplug(self) -> None:
        """Pull the cable; the board goes on. No other terminal of this machine gets its path before `plug`."""
        with self._lock:
            master, self._master = self._master, -1
        if master >= 0:
            os.close(master)

    @property
    def plugged(self) -> bool:
        """Whether the cable is connected."""
        return self._master >= 0

    def reset(self) -> None:
        """Restart the board."""
        with self._lock:
            self.board.reset(time.monotonic())

    def _work(self) -> None:
        while not self._over.is_set():
            with self._lock:
                master = self._master
            ready = []
            if master < 0:
                self._over.wait(_TURN)
            else:
                with suppress(OSError, ValueError):  # it was pulled meanwhile
                    ready = select.select([master], [], [], _TURN)[0]
            with self._lock:
                now = time.monotonic()
                self.board.turn(now)
                if 0 <= self._master == master:
                    self._carry(master, bool(ready))
                if any(self.board.speeds):
                    self.still_since = None
                elif self.still_since is None:
                    self.still_since = time.monotonic()

    def _carry(self, master: int, ready: bool) -> None:
        data = b""
        if ready:
            with suppress(OSError):
                data = os.read(master, 4096)
        if data and self.echo:
            self._send(master, data)
        data = self._pace_bytes(self._damage_bytes(data))
        answer = b"" if self.deaf else self.board.receive(data, time.monotonic())
        if answer and self._random.random() < self.cut:
            answer = answer[: len(answer) // 2]
        self._send(master, self._pace_bytes(self._damage_bytes(answer)) + self.noise)

    def _send(self, master: int, data: bytes) -> None:
        with suppress(OSError):  # nobody reads: a line keeps nothing
            os.write(master, data)

    def _damage_bytes(self, data: bytes) -> bytes:
        if not self.flipped:
            return data
        random, share = self._random, self.flipped
        return bytes(byte ^ random.randint(1, 255) if random.random() < share else byte for byte in data)

    def _pace_bytes(self, data: bytes) -> bytes:
        if self.baud and data:
            time.sleep(len(data) * _BITS / self.baud)
        return data


class SimulatedBoard:
    """A board with these channels. Its sensors measure `readings`; it obeys `commands`; both are by number.

    Faults: the channels in `frozen` measure nothing new; those in `claims` answer with another number; `ahead` is how
    many seconds its clock is ahead.
    """

    def __init__(self, name: str, channels: Iterable[BoardChannel] = CHANNELS, version: int = VERSION) -> None:
        self.name, self.channels, self._version = name, tuple(channels), version
        self.frozen: set[int] = set()
        self.claims: dict[int, int] = {}
        self.ahead = 0.0
        self.reset(0.0)

    def reset(self, now: float) -> None:
        """Restart: all counters begin at 0, and nothing moves."""
        self.readings = {c.number: _FIRST[c.kind] for c in self.channels if c.kind in READINGS}
        self.commands: dict[int, Command] = {
            c.number: command() for c in self.channels if (command := KINDS[c.kind].command)
        }
        self._command_times: dict[int, float] = {}
        self._counts = dict.fromkeys(self.readings, 0)
        self._sampled = dict.fromkeys(self.readings, now)
        self._samples = {number: self._integers(number) for number in self.readings}
        self._started = self._turned = now
        self._session = 0
        self._reader = FrameReader()

    @property
    def speeds(self) -> tuple[float, float]:
        """The metres a second of the wheels of its first drive."""
        drives = (command for command in self.commands.values() if isinstance(command, WheelSpeeds))
        command = next(drives, WheelSpeeds())
        return command.left, command.right

    def receive(self, data: bytes, now: float) -> bytes:
        """Return the answer to bytes of the line."""
        return b"".join(
            encode_frame(answer) for message in self._reader.feed(data) for answer in self._do(message, now)
        )

    def turn(self, now: float) -> None:
        """Go on to a time: move, measure, and bring to rest every channel whose command is too old."""
        for number, commanded in list(self._command_times.items()):
            if now - commanded >= SILENCE:
                self._rest(number)
        for number, command in self.commands.items():
            if number in self.readings:
                self.readings[number] = _move(self.readings[number], command, now - self._turned)
        self._turned = now
        for channel in self.channels:
            if channel.number in self.readings and now - self._sampled[channel.number] >= channel.interval:
                self._sampled[channel.number] = now
                if channel.number not in self.frozen:
                    self._counts[channel.number] = (self._counts[channel.number] + 1) % 256
                    self._samples[channel.number] = self._integers(channel.number)

    def _do(self, message: bytes, now: float) -> Iterable[bytes]:
        if message[0] == STOP and len(message) == 1:
            self._rest_all()
        elif message[0] == ASK_HELLO and (asked := read_ask_hello(message)):
            version, session = asked
            before = self._session
            if session and version == self._version:
                self._session = session
                self._rest_all()
            yield hello_message(Hello(self._version, self.name, self._session, before, self.channels))
        elif message[0] == TELL and (head := read_command_head(message)):
            session, sequence = head
            if session == 0 or session != self._session:
                yield answer_message(BoardAnswer(self._session, sequence, self._milliseconds(now), ()))
            elif self._obey(read_commands(message), now):
                samples = tuple(
                    BoardSample(
                        self.claims.get(channel.number, channel.number),
                        channel.kind,
                        self._counts[channel.number],
                        self._samples[channel.number],
                    )
                    for channel in self.channels
                    if channel.number in self._samples
                )
                yield answer_message(BoardAnswer(self._session, sequence, self._milliseconds(now), samples))

    def _obey(self, commands: tuple[tuple[int, str, bytes], ...] | None, now: float) -> bool:
        kinds = {channel.number: channel.kind for channel in self.channels}
        if commands is None or any(kinds.get(number) != kind for number, kind, _ in commands):
            return False
        for number, kind, data in commands:
            self.commands[number] = COMMANDS[kind].unpack(data)
            if KINDS[kind].moves:
                self._command_times[number] = now
        return True

    def _rest(self, number: int) -> None:
        self.commands[number] = type(self.commands[number])()
        self._command_times.pop(number, None)

    def _rest_all(self) -> None:
        for channel in self.channels:
            if KINDS[channel.kind].moves:
                self._rest(channel.number)

    def _integers(self, number: int) -> tuple[int, ...]:
        kind = next(channel.kind for channel in self.channels if channel.number == number)
        return READINGS[kind].integers(self.readings[number])

    def _milliseconds(self, now: float) -> int:
        return round((now - self._started + self.ahead) * 1000) % 2**32


def _move(reading: Reading, command: Command, seconds: float) -> Reading:
    if isinstance(reading, Wheels) and isinstance(command, WheelSpeeds):
        left, right = reading.left + command.left * seconds, reading.right + command.right * seconds
        return Wheels(left, right, command.left, command.right)
    if isinstance(reading, JointState) and isinstance(command, JointTarget):
        goal = reading.position if command.position is None else command.position
        most = (_JOINT_SPEED if command.speed is None else command.speed) * seconds
        position = reading.position + max(-most, min(most, goal - reading.position))
        speed = (position - reading.position) / seconds if seconds > 0 else 0.0
        return JointState(position, speed, reading.load, reading.temperature, command.loose)
    return reading


def main(name: str) -> None:
    """Show a board with one channel of each kind until Ctrl-C."""
    with suppress(KeyboardInterrupt), SimulatedLine(SimulatedBoard(name)) as line:
        show(line.path)
        while True:
            time.sleep(3600)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "base")

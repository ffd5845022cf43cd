"""A simulated board, which does byte for byte what the firmware does: its wheels and joints obey their commands.

`python -m btlang.devices.serial_board.simulated_board NAME` shows one on a pty, and prints the path of its port.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from contextlib import suppress

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
from btlang.devices.serial_board.frames import FrameReader, encode_frame
from btlang.devices.serial_board.messages import (
    ASK_HELLO,
    STOP,
    TELL,
    VERSION,
    Answer,
    Channel,
    Hello,
    Sample,
    answer_message,
    hello_message,
    read_ask_hello,
    read_command_head,
    read_commands,
)
from btlang.devices.serial_board.simulated_line import SimulatedLine
from btlang.devices.serial_board.values import COMMANDS, READINGS
from btlang.text.output import show

SILENCE = 0.18
"""Seconds without a command after which a channel comes to rest: all is at rest in 0.2 s."""
CHANNELS = (
    Channel(1, "range", 0.05),
    Channel(2, "drive", 0.02),
    Channel(3, "imu", 0.02),
    Channel(4, "battery", 0.5),
    Channel(5, "button", 0.02),
    Channel(6, "joint", 0.02),
    Channel(7, "light", 0.0),
    Channel(8, "display", 0.0),
)
"""One of each kind."""
_FIRST: dict[str, Reading] = {
    "range": Distance(1.0),
    "drive": Wheels(0.0, 0.0, 0.0, 0.0),
    "imu": Motion(0.0, 0.0, 0.0, 9.81, 0.0),
    "battery": Charge(80.0, 12.0, -1.0, 25.0, False),
    "button": Pressed(False),
    "joint": JointState(0.0, 0.0, 10.0, 30.0),
}
_JOINT_SPEED = 90.0  # degrees a second


class SimulatedBoard:
    """A board of these channels. Its sensors measure `readings`; it obeys `commands`; both are by number.

    Faults: the channels in `frozen` measure nothing new; those in `claims` answer with another number; `ahead` are
    seconds that its clock is ahead.
    """

    def __init__(self, name: str, channels: Iterable[Channel] = CHANNELS, version: int = VERSION) -> None:
        self.name, self.channels, self._version = name, tuple(channels), version
        self.frozen: set[int] = set()
        self.claims: dict[int, int] = {}
        self.ahead = 0.0
        self.reset(0.0)

    def reset(self, now: float) -> None:
        """It is started again: all counters begin at 0, and nothing moves."""
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
        """Metres a second of the wheels of its first drive."""
        drives = (command for command in self.commands.values() if isinstance(command, WheelSpeeds))
        command = next(drives, WheelSpeeds())
        return command.left, command.right

    def receive(self, data: bytes, now: float) -> bytes:
        """What it answers to bytes of the line."""
        return b"".join(
            encode_frame(answer) for message in self._reader.feed(data) for answer in self._do(message, now)
        )

    def turn(self, now: float) -> None:
        """Time has passed: moves, measures, and brings to rest every channel whose command is too old."""
        for number, commanded in list(self._command_times.items()):
            if now - commanded >= SILENCE:
                self._rest(number)
        for number, command in self.commands.items():
            if number in self.readings:
                self.readings[number] = _moved(self.readings[number], command, now - self._turned)
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
                yield answer_message(Answer(self._session, sequence, self._milliseconds(now), ()))
            elif self._obey(read_commands(message), now):
                samples = tuple(
                    Sample(
                        self.claims.get(channel.number, channel.number),
                        channel.kind,
                        self._counts[channel.number],
                        self._samples[channel.number],
                    )
                    for channel in self.channels
                    if channel.number in self._samples
                )
                yield answer_message(Answer(self._session, sequence, self._milliseconds(now), samples))

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


def _moved(reading: Reading, command: Command, seconds: float) -> Reading:
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
    """Shows a board with one channel of each kind until Ctrl-C."""
    with suppress(KeyboardInterrupt), SimulatedLine(SimulatedBoard(name)) as line:
        show(line.path)
        while True:
            time.sleep(3600)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "base")

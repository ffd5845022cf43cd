"""A simulated bus of servos behind a pseudo terminal, for tests and for people without servos."""

from __future__ import annotations

import argparse
import os
import random
import select
import threading
import time
import tty
from collections.abc import Iterable
from contextlib import suppress
from struct import pack_into, unpack_from

from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.protocol import (
    ALERT,
    BROADCAST,
    FAST_SYNC_READ,
    PING,
    READ,
    REBOOT,
    SEGMENT_OVERHEAD,
    STATUS,
    SYNC_READ,
    SYNC_WRITE,
    WRITE,
    Packet,
    PacketReader,
    crc16,
)
from btlang.text.output import show

_EEPROM_END = 64
_INDIRECT_COUNT = 20  # those of the smallest models
_FAILED, _RANGE, _LIMIT, _ACCESS = 1, 4, 6, 7
_DATA_LENGTH = 5
_SIZE = 300
_UNKNOWN = 2


class FakeServo:
    """A servo with the settings of a new one, apart from the delay of its answers. Times are of time.monotonic().

    The attributes are faults that may be set at any time: it is `silent`; answers with the id `answers_as`; is `late`
    by some seconds; and it has a fast way of reading only if it `is_fast`.
    """

    def __init__(self, id: int, model: int = 1060, firmware: int = 46, is_fast: bool = True) -> None:
        self.id, self.model = id, model
        self.silent, self.answers_as, self.late, self.is_fast = False, id, 0.0, is_fast
        self.memory = bytearray(_SIZE)
        self._now = time.monotonic()
        self._heard = self._now
        self._exact = float(table.CENTRE)
        m = self.memory
        pack_into("<H4xBB", m, 0, model, firmware, id)
        pack_into("<B", m, table.OPERATING_MODE, table.POSITION_MODE)
        pack_into("<B", m, table.TEMPERATURE_LIMIT, 72)
        pack_into("<Iii", m, table.MAX_POSITION - 4, 265, table.TICKS - 1, 0)
        self.temperature = 30
        self.reboot()

    def reboot(self) -> None:
        """Restart as after a loss of power: torque and watchdog are off, and indirect addresses are forgotten."""
        self.memory[_EEPROM_END:] = bytes(_SIZE - _EEPROM_END)
        data = table.MODELS[self.model].indirect_data if self.model in table.MODELS else 224
        pack_into(f"<{_INDIRECT_COUNT}H", self.memory, table.INDIRECT_ADDRESS, *range(data, data + _INDIRECT_COUNT))
        self.memory[table.STATUS_RETURN] = 2
        self.temperature = self.temperature
        self.turn_to(self._exact)

    @property
    def temperature(self) -> int:
        """The temperature in degrees Celsius."""
        return self._temperature

    @temperature.setter
    def temperature(self, degrees: int) -> None:
        self._temperature = self.memory[table.TEMPERATURE] = degrees

    @property
    def has_torque(self) -> bool:
        """Whether it holds its shaft."""
        return self.memory[table.TORQUE] == 1

    @property
    def position(self) -> float:
        """The position of its shaft, in ticks, at the last instruction on the line."""
        return self._exact

    @property
    def goal(self) -> int:
        """The goal in ticks."""
        goal: int = unpack_from("<i", self.memory, table.GOAL_POSITION)[0]
        return goal

    def turn_to(self, ticks: float) -> None:
        """Turn the shaft by hand."""
        self._exact = ticks
        pack_into("<ii", self.memory, table.VELOCITY, 0, round(ticks))
        if not self.has_torque:
            pack_into("<i", self.memory, table.GOAL_POSITION, round(ticks))

    def fail(self, bits: int) -> None:
        """Set a hardware error: it releases its shaft until it is rebooted."""
        self.memory[table.HARDWARE_ERROR] = bits
        self.memory[table.TORQUE] = 0

    def hear(self, now: float) -> None:
        """Note that an instruction for any servo was on the line."""
        period = self.memory[table.WATCHDOG] * table.WATCHDOG_UNIT
        if self.has_torque and 0 < period < 127 * table.WATCHDOG_UNIT and now - self._heard > period:
            self._move(self._heard + period)
            self.memory[table.WATCHDOG] = table.WATCHDOG_TRIPPED
        self._move(now)
        self._heard = now

    def read(self, address: int, length: int) -> bytes:
        """Read bytes of its control table."""
        return bytes(self.memory[self._at(a)] for a in range(address, address + length))

    def write(self, address: int, data: bytes) -> int:
        """Write to its control table, or return the error why not."""
        cells = [self._at(a) for a in range(address, address + len(data))]
        error = self._error(cells, data)
        if not error:
            for cell, byte in zip(cells, data, strict=True):
                self.memory[cell] = byte
        return error

    def _at(self, address: int) -> int:
        first = table.MODELS[self.model].indirect_data if self.model in table.MODELS else 224
        if first <= address < first + _INDIRECT_COUNT:
            place: int = unpack_from("<H", self.memory, table.INDIRECT_ADDRESS + 2 * (address - first))[0]
            return min(place, _SIZE - 1)
        return min(address, _SIZE - 1)

    def _error(self, cells: list[int], data: bytes) -> int:
        if cells[-1] >= _SIZE - 1:
            return _DATA_LENGTH
        if cells[0] < _EEPROM_END and self.has_torque:
            return _ACCESS
        if table.TORQUE in cells and data[cells.index(table.TORQUE)] and self.memory[table.HARDWARE_ERROR]:
            return _FAILED
        if table.GOAL_POSITION in cells:
            if self.memory[table.WATCHDOG] == table.WATCHDOG_TRIPPED:
                return _RANGE
            goal: int = unpack_from("<i", data, cells.index(table.GOAL_POSITION))[0]
            high, low = unpack_from("<ii", self.memory, table.MAX_POSITION)
            if not low <= goal <= high:
                return _LIMIT
        return 0

    def _move(self, now: float) -> None:
        seconds, self._now = max(now - self._now, 0.0), max(now, self._now)
        if not self.has_torque or self.memory[table.WATCHDOG] == table.WATCHDOG_TRIPPED:
            self.turn_to(self._exact)
            return
        fastest: int = unpack_from("<I", self.memory, table.PROFILE_VELOCITY)[0] or table.TICKS
        most = fastest * table.SPEED_UNIT * table.TICKS / 360 * seconds
        step = min(max(self.goal - self._exact, -most), most)
        self._exact += step
        velocity = 0 if step == 0 else fastest if step > 0 else -fastest
        pack_into("<ii", self.memory, table.VELOCITY, velocity, round(self._exact))


class FakeBus:
    """Servos by their ids on a port of this machine, from `start` to `close`; also a context manager.

    Faults that may be set at any time: `damage` is the share of bytes that arrive flipped in both directions, with
    `echo` what is sent comes back too, and `baud` paces both directions like a line. As on a real line, a servo behind
    a silent one in a common answer waits for it in vain.
    """

    def __init__(self, servos: Iterable[FakeServo], seed: int = 0) -> None:
        self.servos = {servo.id: servo for servo in servos}
        self.damage, self.echo, self.baud = 0.0, False, 0
        self.heard: dict[int, int] = {}
        """How often each instruction was heard."""
        self._random = random.Random(seed)
        self._file, self._other = os.openpty()
        tty.setraw(self._other)
        self.port = os.ttyname(self._other)
        """The path to open."""
        self._wake, self._woken = os.pipe()
        self._thread = threading.Thread(target=self._serve, name="fake Dynamixel bus", daemon=True)

    def start(self) -> FakeBus:
        """Begin to answer."""
        self._thread.start()
        return self

    def unplug(self) -> None:
        """Pull the cable. No other terminal of this machine gets the path before `close`."""
        if self._file < 0:
            return
        os.write(self._woken, b"x")
        if self._thread.ident is not None:
            self._thread.join()
        for file in (self._file, self._wake, self._woken):
            os.close(file)
        self._file = -1

    def close(self) -> None:
        """Remove the port. May be called twice."""
        self.unplug()
        if self._other >= 0:
            os.close(self._other)
        self._other = -1

    def __enter__(self) -> FakeBus:
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _serve(self) -> None:
        reader = PacketReader()
        while True:
            ready = select.select((self._file, self._wake), (), ())[0]
            if self._wake in ready:
                return
            data = os.read(self._file, 4096)
            self._pace(len(data))
            if self.echo:
                self._send(data)
            for packet in reader.feed(self._damage_bytes(data)):
                self._hear(packet)

    def _hear(self, packet: Packet) -> None:
        now = time.monotonic()
        self.heard[packet.instruction] = self.heard.get(packet.instruction, 0) + 1
        for servo in self.servos.values():
            servo.hear(now)
        with suppress(IndexError, ValueError):  # too few parameters: nobody answers
            if packet.id != BROADCAST:
                if packet.id in self.servos:
                    self._answer(self.servos[packet.id], *self._do(self.servos[packet.id], packet))
            elif packet.instruction == PING:
                for servo in self.servos.values():
                    self._answer(servo, *self._do(servo, packet))
            elif packet.instruction in (SYNC_READ, FAST_SYNC_READ):
                self._sync_read(packet)
            elif packet.instruction == SYNC_WRITE:
                address, size = _words(packet.parameters)
                for at in range(4, len(packet.parameters), size + 1):
                    id, data = packet.parameters[at], packet.parameters[at + 1 : at + 1 + size]
                    if id in self.servos:
                        self.servos[id].write(address, data)

    def _do(self, servo: FakeServo, packet: Packet) -> tuple[int, bytes]:
        """Do an instruction on a servo; return the error and the data of its answer."""
        if packet.instruction == PING:
            return 0, servo.read(0, 2) + servo.read(6, 1)
        if packet.instruction == READ:
            return 0, servo.read(*_words(packet.parameters))
        if packet.instruction == WRITE:
            return servo.write(_words(packet.parameters + b"\0\0")[0], packet.parameters[2:]), b""
        if packet.instruction == REBOOT:
            servo.reboot()
            return 0, b""
        return _UNKNOWN, b""

    def _answer(self, servo: FakeServo, error: int, data: bytes) -> None:
        if servo.silent:
            return
        self._wait(servo)
        self._send(Packet(servo.answers_as, STATUS, bytes((error | _alert(servo),)) + data).encode())

    def _sync_read(self, packet: Packet) -> None:
        address, size = _words(packet.parameters)
        servos = [self.servos.get(id) for id in packet.parameters[4:]]
        fast = packet.instruction == FAST_SYNC_READ
        length = 1 + len(servos) * (size + SEGMENT_OVERHEAD)
        answer = b"\xff\xff\xfd\x00\xfe" + length.to_bytes(2, "little") + bytes((STATUS,))
        for servo in servos:
            if servo is None or servo.silent or (fast and not servo.is_fast):
                break
            if not fast:
                self._answer(servo, 0, servo.read(address, size))
                continue
            part = bytes((_alert(servo), servo.answers_as)) + servo.read(address, size)
            self._wait(servo)
            answer += part
            answer += crc16(answer).to_bytes(2, "little")
        if fast and len(answer) > 8:
            self._send(answer)

    def _send(self, data: bytes) -> None:
        self._pace(len(data))
        with suppress(OSError):
            os.write(self._file, self._damage_bytes(data))

    def _wait(self, servo: FakeServo) -> None:
        """Wait for a late servo: what is sent meanwhile collides with its answer, and nobody hears it."""
        if servo.late:
            time.sleep(servo.late)
            while select.select((self._file,), (), (), 0)[0]:
                os.read(self._file, 4096)

    def _pace(self, count: int) -> None:
        if self.baud:
            time.sleep(count * 10 / self.baud)

    def _damage_bytes(self, data: bytes) -> bytes:
        if not self.damage:
            return data
        flips = (1 << self._random.randrange(8) if self._random.random() < self.damage else 0 for _ in data)
        return bytes(byte ^ flip for byte, flip in zip(data, flips, strict=True))


def _alert(servo: FakeServo) -> int:
    return ALERT if servo.memory[table.HARDWARE_ERROR] else 0


def _words(parameters: bytes) -> tuple[int, int]:
    return int.from_bytes(parameters[:2], "little"), int.from_bytes(parameters[2:4], "little")


def main() -> None:
    """Serve a bus until Ctrl-C."""
    options = argparse.ArgumentParser(description="Simulated Dynamixel servos on a pseudo terminal.")
    options.add_argument("ids", type=int, nargs="*", default=[1], metavar="ID", help="ids of the servos")
    given = options.parse_args()
    with FakeBus(FakeServo(id) for id in given.ids) as bus:
        show(bus.port)
        with suppress(KeyboardInterrupt):
            threading.Event().wait()


if __name__ == "__main__":
    main()

"""A serial port with servos on it: asks them and writes to them, and waits for answers with `select`."""

from __future__ import annotations

import os
import select
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress

from btlang.devices.driver import DeviceError, DeviceSilent
from btlang.devices.dynamixel.protocol import (
    ALERT,
    ERRORS,
    OVERHEAD,
    PING,
    SEGMENT_OVERHEAD,
    STATUS,
    Packet,
    PacketReader,
    read_packet,
    sync_read_packet,
    sync_write_packet,
    write_packet,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from serial import Serial

PATIENCE = 0.008
"""Seconds that an adapter and a busy computer may add to an answer."""
LONGEST_DELAY = 0.000508
"""The longest answer delay in seconds that a servo can be set to, which is also that of a new one."""
_TRIES = 5


class LineLost(DeviceError):
    """The error that a port can't be opened, or can't be read or written any more."""


class SerialLine:
    """A port and its bits a second. All methods but `close` raise LineLost once it is lost."""

    def __init__(self, port: str, baud: int) -> None:
        self.port, self.baud = port, baud
        self.sent_by = 0.0
        """When everything that was sent is out (of time.monotonic()): a slow line needs time."""
        self._serial: Serial | None = None

    def open(self) -> None:
        """Open it for this process alone. Raises LineLost if that can't be done."""
        try:
            import serial
        except ImportError:
            raise LineLost("serial ports need the package pyserial: pip install 'btlang[serial]'") from None
        self.close()
        try:
            self._serial = serial.Serial(self.port, self.baud, timeout=0, exclusive=True)
        except (OSError, ValueError) as problem:  # serial.SerialException is an OSError
            raise LineLost(f"the port {self.port} can't be opened: {_reason(problem)}") from None
        with suppress(OSError, ValueError):  # a USB adapter otherwise keeps what it got for 16 ms; others don't know it
            self._serial.set_low_latency_mode(True)

    def close(self) -> None:
        """Close the port. May be called twice."""
        if self._serial is not None:
            with suppress(OSError):
                self._serial.close()
            self._serial = None

    def seconds(self, count: int) -> float:
        """Return how long as many bytes take on the line."""
        return count * 10 / self.baud

    def send(self, data: bytes) -> None:
        """Send bytes, and forget what has come before: it answers something else."""
        try:
            file = self._file()
            while select.select((file,), (), (), 0)[0]:
                if not os.read(file, 4096):
                    raise OSError("it was pulled out")
            self.sent_by = max(self.sent_by, time.monotonic()) + self.seconds(len(data))
            while data:
                with suppress(BlockingIOError):
                    data = data[os.write(file, data) :]
                if data and not select.select((), (file,), (), 1.0)[1]:
                    raise OSError("it takes nothing")
        except (OSError, ValueError) as problem:
            raise self._lost(problem) from None

    def receive(self, until: float) -> bytes:
        """Return the next bytes as soon as there are some; none if nothing comes until then (of time.monotonic())."""
        try:
            file = self._file()
            wait = max(until - time.monotonic(), 0.0)
            if not select.select((file,), (), (), wait)[0]:
                return b""
            data = os.read(file, 4096)
        except (OSError, ValueError) as problem:
            raise self._lost(problem) from None
        if not data:
            raise self._lost(OSError("it was pulled out"))
        return data

    def _file(self) -> int:
        if self._serial is None:
            raise OSError("it is not open")
        file: int = self._serial.fileno()
        return file

    def _lost(self, problem: Exception) -> LineLost:
        return LineLost(f"the port {self.port} is lost: {_reason(problem)}")


def _reason(problem: Exception) -> str:
    number = getattr(problem, "errno", None)
    return os.strerror(number) if isinstance(number, int) else str(problem)


class ServoClient:
    """The servos on a line. All methods raise LineLost when the line is lost.

    `delay` is how long each servo may wait before it answers, in seconds.
    """

    def __init__(self, line: SerialLine) -> None:
        self.line = line
        self.delay = LONGEST_DELAY
        self._pending = b""
        self._written: dict[int, tuple[Mapping[int, bytes], bytes]] = {}  # the latest to each address, and its packet

    def ping(self, id: int) -> tuple[int, int] | None:
        """Return the model number and firmware of a servo, None if it doesn't answer."""
        found = self._ask(Packet(id, PING), (id,), 3)
        data = found.get(id)
        return None if data is None else (int.from_bytes(data[1:3], "little"), data[3])

    def read(self, id: int, address: int, length: int) -> bytes:
        """Read bytes from an address on, with several tries. Raises DeviceSilent if the servo never answers."""
        for _ in range(_TRIES):
            found = self._ask(read_packet(id, address, length), (id,), length)
            if found:
                return found[id][1:]
        raise DeviceSilent(f"servo {id} on {self.line.port} doesn't answer")

    def write(self, id: int, address: int, data: bytes) -> None:
        """Write bytes, in several tries. Raises DeviceSilent if the servo is silent, DeviceError if it refuses."""
        for _ in range(_TRIES):
            found = self._ask(write_packet(id, address, data), (id,), 0)
            if not found:
                continue
            error = found[id][0] & ~ALERT
            if error:
                reason = ERRORS.get(error, f"error {error}")
                raise DeviceError(f"servo {id} on {self.line.port} refuses a value for its address {address}: {reason}")
            return
        raise DeviceSilent(f"servo {id} on {self.line.port} doesn't answer")

    def sync_write(self, address: int, values: Mapping[int, bytes]) -> None:
        """Write to several servos at once, with the next question or `flush`. Nothing reports whether it arrived."""
        if not values:
            return
        latest, data = self._written.get(address, ({}, b""))
        if latest != values:  # most goals stay the same for many cycles
            data = sync_write_packet(address, values).encode()
            self._written[address] = values, data
        self._pending += data

    def flush(self) -> None:
        """Send what waits for the next question."""
        data, self._pending = self._pending, b""
        if data:
            self.line.send(data)

    def sync_read(self, address: int, length: int, ids: Sequence[int], fast: bool = False) -> dict[int, bytes]:
        """Return the same bytes of several servos, by id.

        A servo that doesn't answer is left out, and so is an answer that comes twice or out of order: then somebody
        answers with another's id.
        """
        if not ids:
            return {}
        found = self._ask(sync_read_packet(address, length, ids, fast), ids, length, fast)
        return {id: parameters[1:] for id, parameters in found.items()}

    def _ask(self, packet: Packet, ids: Sequence[int], length: int, fast: bool = False) -> dict[int, bytes]:
        """Return the parameters of the status packets of these servos, as far as they came in time."""
        self._pending += packet.encode()
        self.flush()
        answer = self.line.seconds((length + (SEGMENT_OVERHEAD if fast else OVERHEAD)) * len(ids))
        until = self.line.sent_by + answer + self.delay * len(ids) + PATIENCE
        reader = PacketReader(length, len(ids)) if fast else PacketReader()
        came: list[tuple[int, bytes]] = []
        while len(came) < len(ids):
            got = self.line.receive(until)
            came += [
                (found.id, found.parameters)
                for found in (reader.feed(got) if got else reader.rest())
                if found.instruction == STATUS and found.id in ids and len(found.parameters) == length + 1
            ]
            if not got:
                break
        return _in_order(came, ids)


def _in_order(came: Sequence[tuple[int, bytes]], ids: Sequence[int]) -> dict[int, bytes]:
    found = dict(came)
    if len(found) == len(came) and list(found) == [id for id in ids if id in found]:
        return found
    places = [ids.index(id) for id, _ in came]
    return {
        id: parameters
        for at, (id, parameters) in enumerate(came)
        if places.count(places[at]) == 1 and all(later > places[at] for later in places[at + 1 :])
    }

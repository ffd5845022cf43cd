"""A serial port with frames on it (COBS and CRC-16), and the ports of this computer at which a board answers."""

from __future__ import annotations

import os
import time
from binascii import crc_hqx
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from errno import EAGAIN
from random import randrange
from typing import TYPE_CHECKING

from btlang.devices.driver import DeviceError
from btlang.devices.serial_board.messages import STOP, VERSION, Hello, ask_hello, read_hello

if TYPE_CHECKING:
    import serial


MOST = 250
"""The most bytes of a message with its CRC, so that no block of COBS is full, and all end at a zero."""

MOST_MESSAGE = MOST - 2
FRAMING = 4
"""Bytes of a frame in addition to its message: the CRC, one of COBS, the zero."""
HELLO_WAIT = 3.0
"""Seconds for a board to say hello; some restart when their port is opened, which takes two."""
_ASKED_EVERY = 0.1
_LOOK = 0.01  # seconds that a read blocks at most
_MOST_BYTES = 4096  # between two messages to a board, which answers each with one frame
_CLOSED, _LOST = "can't be opened", "is lost"
_MISSING = (
    "serial-board needs the Python package pyserial, which isn't installed. Install it: pip install 'btlang[serial]'"
)


def crc16(data: bytes) -> int:
    """Return the CRC-16/CCITT-FALSE: polynomial 0x1021, begins with 0xFFFF, nothing reflected."""
    return crc_hqx(data, 0xFFFF)


def encode_frame(message: bytes) -> bytes:
    """Return the frame of a message. Raises ValueError if it is too long."""
    checked = message + crc16(message).to_bytes(2, "little")
    if len(checked) > MOST:
        raise ValueError(f"a message of {len(message)} bytes; at most {MOST_MESSAGE} fit in a frame")
    return b"".join(bytes([len(block) + 1]) + block for block in checked.split(b"\0")) + b"\0"


def decode_frame(frame: bytes) -> bytes | None:
    """Return the message of a frame, given without the zero at its end; None if it isn't one, or was damaged."""
    if len(frame) > MOST + 1:
        return None
    blocks, at = [], 0
    while at < len(frame):
        size = frame[at]
        blocks.append(frame[at + 1 : at + size])
        if len(blocks[-1]) != size - 1:
            return None
        at += size
    checked = b"\0".join(blocks)
    if len(checked) < 3 or crc16(checked[:-2]) != int.from_bytes(checked[-2:], "little"):
        return None
    return checked[:-2]


class FrameReader:
    """A reader of messages from the bytes of a line, in pieces of any size. It keeps at most one frame."""

    def __init__(self) -> None:
        self._rest = b""
        self.damaged = 0
        """Frames that couldn't be read so far."""

    def feed(self, data: bytes) -> list[bytes]:
        """Return the messages that end in these bytes."""
        *frames, rest = (self._rest + data).split(b"\0")
        self._rest = rest[: MOST + 2]  # what is too long by now is still so at its end
        messages = [decode_frame(frame) for frame in frames if frame]
        found = [message for message in messages if message is not None]
        self.damaged += len(messages) - len(found)
        return found


class BoardLine:
    """An open serial port. Raises DeviceError if it can't be opened or is lost."""

    def __init__(self, path: str, baud: int) -> None:
        try:
            from serial import Serial
        except ImportError:
            raise DeviceError(_MISSING) from None
        self.path = path
        self._reader, self._received, self._sent, self._echoes = FrameReader(), 0, b"", 0
        with self._named(_CLOSED):
            self._port: serial.Serial = Serial(path, baud, timeout=_LOOK, write_timeout=_ASKED_EVERY, exclusive=True)

    def send(self, message: bytes) -> None:
        """Send a message as a frame."""
        self._sent, self._received = message, 0
        with self._named():
            self._port.write(encode_frame(message))

    def receive(self, until: float) -> list[bytes]:
        """Wait for messages until a time of the monotonic clock. Raises DeviceError if bytes flood in."""
        while True:
            with self._named():
                data = self._port.read(self._port.in_waiting or 1)
            self._received += len(data)
            if self._received > _MOST_BYTES:
                raise DeviceError(f"{self.path} is flooded: more than {_MOST_BYTES} bytes came in place of an answer")
            messages = self._reader.feed(data)
            self._echoes += self._sent in messages
            if messages or time.monotonic() >= until:
                return messages

    def silence(self) -> str:
        """Return what came in place of a hello."""
        if self._echoes:
            return "only an echo of what is sent comes back"
        if self._reader.damaged or self._received:
            return "what comes from there are no frames (is the baud rate right?)"
        return "nothing answers"

    def stop(self) -> None:
        """Command a board to bring everything to rest, as far as it can be reached."""
        with suppress(DeviceError):
            for _ in range(3):  # one may be damaged on its way
                self.send(bytes([STOP]))

    def close(self) -> None:
        """Close the port."""
        with suppress(OSError):
            self._port.close()

    @contextmanager
    def _named(self, what: str = _LOST) -> Iterator[None]:
        try:
            yield
        except (OSError, ValueError) as problem:  # pyserial's own are of these
            number = getattr(problem, "errno", None)
            named = {
                None: str(problem) if what == _CLOSED else "it was unplugged, or hangs",
                EAGAIN: "another program uses it",
            }
            reason = named.get(number) or os.strerror(number or 0).lower()
            raise DeviceError(f"{self.path} {what}: {reason}") from None


def serial_ports() -> list[str]:
    """Return the paths of all serial ports of this computer."""
    try:
        from serial.tools.list_ports import comports
    except ImportError:
        raise DeviceError(_MISSING) from None
    return [port.device for port in comports()]


def begin_session(line: BoardLine) -> Hello:
    """Begin a session with the board of a line. Raises DeviceError if there's none, or for another version."""
    session = randrange(1, 2**16)
    hello = _ask([line], session).get(line)
    if hello is None:
        raise DeviceError(f"no board at {line.path}: {line.silence()}")
    if hello.version != VERSION:
        newer = "Update btlang" if hello.version > VERSION else "Update the firmware of the board"
        raise DeviceError(
            f"the board '{hello.name}' at {line.path} speaks version {hello.version} of the protocol, "
            f"btlang version {VERSION}. {newer}"
        )
    return hello


def find_board(name: str, baud: int) -> BoardLine:
    """Return the line of the board of that name. Raises DeviceError if there's none, or more than one."""
    lines, locked = [], []
    for path in serial_ports():
        try:
            lines.append(BoardLine(path, baud))
        except DeviceError as problem:
            locked.append(str(problem))
    found: list[BoardLine] = []
    others: set[str] = set()
    try:
        for line, hello in _ask(lines, 0).items():
            found += [line] if hello.name == name else []
            others |= {f"'{hello.name}' at {line.path}"} - {f"'{name}' at {line.path}"}
        if len(found) == 1:
            return found[0]
        if found:
            places = " and ".join(sorted(line.path for line in found))
            raise DeviceError(f"two boards are called '{name}': at {places}. Give one another name")
        seen = f"found: {', '.join(sorted(others))}" if others else f"{len(lines)} serial ports asked"
        reasons = "".join(f"; {reason}" for reason in locked)
        raise DeviceError(f"no board called '{name}' answers ({seen}{reasons})")
    finally:
        for line in lines:
            if found != [line]:
                line.close()


def _ask(lines: Sequence[BoardLine], session: int) -> dict[BoardLine, Hello]:
    """Return the boards that answer at these lines. Waits for all of them: a second board of
    one name may need longer.
    """
    found: dict[BoardLine, Hello] = {}
    pending = list(lines)
    due = time.monotonic()
    until = due + HELLO_WAIT
    while pending and time.monotonic() < until:
        asks = time.monotonic() >= due
        due += _ASKED_EVERY if asks else 0.0
        for line in list(pending):
            try:
                if asks:
                    line.send(ask_hello(session))
                for hello in filter(None, map(read_hello, line.receive(0.0))):
                    if hello.version != VERSION or hello.session == session or not session:
                        found[line] = hello
            except DeviceError:
                if len(lines) == 1:
                    raise
                pending.remove(line)
            if line in found:
                pending.remove(line)
    return found

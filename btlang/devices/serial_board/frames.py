"""Frames on a serial line: COBS, a zero at the end, and a CRC-16 that shows whether a frame arrived as it was sent."""

from __future__ import annotations

from binascii import crc_hqx

MOST = 250
"""Bytes of a message with its CRC at most, so that no block of COBS is full, and all end at a zero."""

MOST_MESSAGE = MOST - 2
FRAMING = 4
"""Bytes of a frame beside its message: the CRC, one of COBS, the zero."""


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE: polynomial 0x1021, begins with 0xFFFF, nothing reflected."""
    return crc_hqx(data, 0xFFFF)


def encode_frame(message: bytes) -> bytes:
    """The frame of a message. Raises ValueError where it is too long."""
    checked = message + crc16(message).to_bytes(2, "little")
    if len(checked) > MOST:
        raise ValueError(f"a message of {len(message)} bytes; at most {MOST_MESSAGE} fit in a frame")
    return b"".join(bytes([len(block) + 1]) + block for block in checked.split(b"\0")) + b"\0"


def decode_frame(frame: bytes) -> bytes | None:
    """The message of a frame, given without the zero at its end; None where it isn't one, or was damaged."""
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
    """Finds the messages in the bytes of a line, in pieces of any size. It keeps at most one frame."""

    def __init__(self) -> None:
        self._rest = b""
        self.damaged = 0
        """Frames that couldn't be read so far."""

    def feed(self, data: bytes) -> list[bytes]:
        """The messages that end in these bytes."""
        *frames, rest = (self._rest + data).split(b"\0")
        self._rest = rest[: MOST + 2]  # what is too long by now is still so at its end
        messages = [decode_frame(frame) for frame in frames if frame]
        found = [message for message in messages if message is not None]
        self.damaged += len(messages) - len(found)
        return found

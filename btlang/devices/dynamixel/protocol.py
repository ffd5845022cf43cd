"""Dynamixel Protocol 2.0: packets made and read (https://emanual.robotis.com/docs/en/dxl/protocol2/)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from btlang.support.record import Record

BROADCAST = 0xFE
HIGHEST_ID = 252
PING, READ, WRITE, REBOOT, STATUS, SYNC_READ, SYNC_WRITE, FAST_SYNC_READ = 1, 2, 3, 8, 0x55, 0x82, 0x83, 0x8A
ALERT = 0x80
"""The bit of an error byte that refers to the hardware error status."""
ERRORS = {
    1: "it could not do what it was asked",
    2: "it does not know the instruction",
    3: "what it received was damaged",
    4: "a value is out of range",
    5: "a value has the wrong length",
    6: "a value is beyond a limit",
    7: "the address can't be written or read now",
}
"""The errors by the error byte of a status packet without the alert bit."""
OVERHEAD = 11  # bytes of a status packet beside its data
SEGMENT_OVERHEAD = 4  # bytes of each servo in the answer to a fast sync read, beside its data
_HEADER = b"\xff\xff\xfd\x00"
_STUFFED, _PLAIN = b"\xff\xff\xfd\xfd", b"\xff\xff\xfd"
_HEAD = 7  # bytes up to the length field and with it
_LONGEST = 1024


def _crc_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        crc = byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x8005 if crc & 0x8000 else crc << 1) & 0xFFFF
        table.append(crc)
    return tuple(table)


_TABLE = _crc_table()


def crc16(data: Iterable[int], crc: int = 0) -> int:
    """Return the CRC-16 with the polynomial 0x8005, going on from `crc`."""
    table = _TABLE
    for byte in data:
        crc = (crc << 8 & 0xFF00) ^ table[crc >> 8 ^ byte]
    return crc


class Packet(Record):
    """An instruction, or a status, whose parameters are an error byte and data."""

    id: int
    instruction: int
    parameters: bytes = b""

    def encode(self) -> bytes:
        """Return its bytes on the line."""
        body = (bytes((self.instruction,)) + self.parameters).replace(_PLAIN, _STUFFED)
        packet = _HEADER + bytes((self.id,)) + (len(body) + 2).to_bytes(2, "little") + body
        return packet + crc16(packet).to_bytes(2, "little")


def read_packet(id: int, address: int, length: int) -> Packet:
    """Return a packet that asks a servo for `length` bytes from an address on."""
    return Packet(id, READ, _words(address, length))


def write_packet(id: int, address: int, data: bytes) -> Packet:
    """Return a packet that writes bytes from an address on."""
    return Packet(id, WRITE, _words(address) + data)


def sync_read_packet(address: int, length: int, ids: Iterable[int], fast: bool = False) -> Packet:
    """Return a packet that asks several servos for the same bytes.

    They answer in that order, each with a packet, or `fast` all in one.
    """
    return Packet(BROADCAST, FAST_SYNC_READ if fast else SYNC_READ, _words(address, length) + bytes(ids))


def sync_write_packet(address: int, values: Mapping[int, bytes]) -> Packet:
    """Return a packet that writes to several servos by id, the same number of bytes each. None answers."""
    length = len(next(iter(values.values())))
    return Packet(BROADCAST, SYNC_WRITE, _words(address, length) + b"".join(bytes((i,)) + d for i, d in values.items()))


def _words(*values: int) -> bytes:
    return b"".join(value.to_bytes(2, "little") for value in values)


class PacketReader:
    """A reader of packets in a stream of bytes, whatever is between them, which drops those with a wrong checksum.

    After a fast sync read, `parts` is how many servos were asked for how many bytes, `segment`: the parts of their
    common answer come out as a status packet of each servo; of a damaged answer, those before the damage.
    """

    def __init__(self, segment: int = 0, parts: int = 0) -> None:
        self._size = segment + SEGMENT_OVERHEAD
        self._common_length = 1 + parts * self._size
        self._bytes = bytearray()

    def feed(self, data: bytes) -> list[Packet]:
        """Return the packets that are complete with these bytes."""
        self._bytes += data
        found: list[Packet] = []
        while self._find_header() and self._take(found):
            pass
        return found

    def rest(self) -> list[Packet]:
        """Return, when nothing more comes, the intact parts of an incomplete packet, and the packets behind it."""
        found: list[Packet] = []
        while self._find_header():
            if self._is_common():
                self._take_parts(found, len(self._bytes))
            self._drop(1)
            found += self.feed(b"")
        return found

    def _find_header(self) -> bool:
        start = self._bytes.find(_HEADER)
        if start:
            self._drop(start if start > 0 else max(len(self._bytes) - len(_HEADER) + 1, 0))
        return start >= 0 and len(self._bytes) > _HEAD

    def _drop(self, count: int) -> None:
        if count:
            del self._bytes[:count]

    def _take(self, found: list[Packet]) -> bool:
        """Take the packet at the start, or drop its header. Returns False if more bytes are needed."""
        got = self._bytes
        length = int.from_bytes(got[5:_HEAD], "little")
        end = _HEAD + length
        if not 3 <= length <= _LONGEST:
            self._drop(1)
            return True
        if len(got) < end:
            return False
        is_intact = crc16(got[: end - 2]) == int.from_bytes(got[end - 2 : end], "little")
        if self._is_common():
            self._take_parts(found, end, is_intact)
            self._drop(end if is_intact else 1)
        elif is_intact:
            body = bytes(got[_HEAD : end - 2]).replace(_STUFFED, _PLAIN)
            found.append(Packet(got[4], body[0], body[1:]))
            self._drop(end)
        else:
            self._drop(1)
        return True

    def _is_common(self) -> bool:
        got = self._bytes  # its length distinguishes it from a late answer to a question for other bytes
        return (
            got[_HEAD] == STATUS
            and got[4] == BROADCAST
            and int.from_bytes(got[5:_HEAD], "little") == self._common_length
        )

    def _take_parts(self, found: list[Packet], end: int, is_intact: bool = False) -> None:
        """Take the parts of a common answer: each has the checksum of all before it and itself."""
        got, size = bytes(self._bytes[:end]), self._size
        crc, begin = 0, 0
        for start in range(_HEAD + 1, end - size + 1, size):
            stop = start + size - 2
            if not is_intact or not begin:  # the first says whether the parts are as long as asked for
                crc, begin = crc16(got[begin:stop], crc), stop
                if crc != int.from_bytes(got[stop : stop + 2], "little"):
                    return
            found.append(Packet(got[start + 1], STATUS, got[start : start + 1] + got[start + 2 : stop]))

"""Packets of Dynamixel Protocol 2.0: the examples of its documentation, and dynamixel-sdk as the oracle."""

from __future__ import annotations

from typing import Any

import pytest
from dynamixel_sdk import COMM_SUCCESS, Protocol2PacketHandler
from hypothesis import assume, example, given
from hypothesis import strategies as st

from btlang.devices.dynamixel.protocol import (
    BROADCAST,
    PING,
    REBOOT,
    STATUS,
    Packet,
    PacketReader,
    crc16,
    read_packet,
    sync_read_packet,
    sync_write_packet,
    write_packet,
)
from tests.profiles import searches


class Oracle(Protocol2PacketHandler):
    """dynamixel-sdk 4.1 for Python computes the byte stuffing of what it sends, and sends it without."""

    def addStuffing(self, packet: list[int]) -> list[int]:
        packet[:] = super().addStuffing(packet)
        return packet


HANDLER = Oracle()
TRICKY = st.sampled_from((0xFF, 0xFD, 0x00, 0x55, 0x01))
DATA = st.lists(TRICKY | st.integers(0, 255), max_size=40).map(bytes)
IDS = st.lists(st.integers(0, 252), min_size=1, max_size=20, unique=True)


class FakePort:
    """What dynamixel-sdk calls a port: it keeps what is written and gives what there is to read."""

    def __init__(self, incoming: bytes = b"") -> None:
        self.is_using, self.written, self._incoming = False, b"", bytearray(incoming)

    def writePort(self, packet: list[int]) -> int:
        self.written = bytes(packet)
        return len(packet)

    def readPort(self, length: int) -> bytes:
        data = bytes(self._incoming[:length])
        del self._incoming[:length]
        return data

    def clearPort(self) -> None: ...

    def setPacketTimeout(self, _length: int) -> None: ...

    def isPacketTimeout(self) -> bool:
        return not self._incoming


@pytest.mark.parametrize(
    ("packet", "expected"),
    [
        (Packet(BROADCAST, PING), "FF FF FD 00 FE 03 00 01 31 42"),
        (Packet(1, STATUS, b"\0\6\4\x26"), "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D"),
        (Packet(2, STATUS, b"\0\6\4\x26"), "FF FF FD 00 02 07 00 55 00 06 04 26 6F 6D"),
        (read_packet(1, 132, 4), "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"),
        (Packet(1, STATUS, b"\0\xa6\0\0\0"), "FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0"),
        (write_packet(1, 116, b"\0\2\0\0"), "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"),
        (Packet(1, STATUS, b"\0"), "FF FF FD 00 01 04 00 55 00 A1 0C"),
        (Packet(1, REBOOT), "FF FF FD 00 01 03 00 08 2F 4E"),
        (sync_read_packet(132, 4, (1, 2)), "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA"),
        (
            sync_write_packet(116, {1: b"\x96\0\0\0", 2: b"\xaa\0\0\0"}),
            "FF FF FD 00 FE 11 00 83 74 00 04 00 01 96 00 00 00 02 AA 00 00 00 82 87",
        ),
        (sync_read_packet(132, 4, (3, 7, 4), fast=True), "FF FF FD 00 FE 0A 00 8A 84 00 04 00 03 07 04 20 F2"),
        (sync_read_packet(580, 4, (1, 2), fast=True), "FF FF FD 00 FE 09 00 8A 44 02 04 00 01 02 72 F2"),
    ],
)
def test_packets_are_those_of_the_documentation(packet: Packet, expected: str) -> None:
    assert packet.encode() == bytes.fromhex(expected)
    assert PacketReader().feed(bytes.fromhex(expected)) == [packet]


FAST_ANSWER = bytes.fromhex(
    "FF FF FD 00 FE 19 00 55 00 03 A6 00 00 00 84 08 00 07 1F 08 00 00 16 CA 00 04 FF 03 00 00 D1 9E"
)


FAST_PARTS = [
    Packet(3, STATUS, b"\0\xa6\0\0\0"),
    Packet(7, STATUS, b"\0\x1f\x08\0\0"),
    Packet(4, STATUS, b"\0\xff\x03\0\0"),
]


@pytest.mark.parametrize("end", range(len(FAST_ANSWER) + 1))
def test_the_common_answer_of_the_documentation_is_read_as_far_as_it_came(end: int) -> None:
    reader = PacketReader(segment=4, parts=3)
    found = [packet for byte in FAST_ANSWER[:end] for packet in reader.feed(bytes((byte,)))]
    assert found == (FAST_PARTS if end == len(FAST_ANSWER) else [])
    assert found + reader.rest() == FAST_PARTS[: max(end - 8, 0) // 8]


@pytest.mark.parametrize(("segment", "parts"), [(4, 2), (4, 4), (8, 2), (2, 4)])
def test_a_common_answer_to_another_question_is_none(segment: int, parts: int) -> None:
    reader = PacketReader(segment, parts)
    assert [packet for packet in reader.feed(FAST_ANSWER) + reader.rest() if packet.id != BROADCAST] == []


@given(DATA)
@searches(100, 4000)
def test_checksums_are_those_of_the_oracle(data: bytes) -> None:
    assert crc16(data) == HANDLER.updateCRC(0, data, len(data))


@given(id=st.integers(0, 252), address=st.integers(0, 600), data=DATA, ids=IDS, fast=st.booleans())
@example(id=1, address=116, data=b"\xff\xff\xfd", ids=[1], fast=True)
@searches(200, 4000)
def test_instructions_are_those_of_the_oracle(id: int, address: int, data: bytes, ids: list[int], fast: bool) -> None:
    def sent(call: Any, *arguments: Any) -> bytes:
        port = FakePort()
        assert call(port, *arguments) == COMM_SUCCESS
        return port.written

    length = len(data)
    assert sent(HANDLER.readTx, id, address, length) == read_packet(id, address, length).encode()
    assert sent(HANDLER.writeTxOnly, id, address, length, list(data)) == write_packet(id, address, data).encode()
    assert (
        sent(HANDLER.syncReadTx, address, length, ids, len(ids), fast)
        == sync_read_packet(address, length, ids, fast).encode()
    )
    values = dict.fromkeys(ids, data)
    parameters = [byte for id, those in values.items() for byte in (id, *those)]
    assert (
        sent(HANDLER.syncWriteTxOnly, address, length, parameters, len(parameters))
        == sync_write_packet(address, values).encode()
    )


@given(id=st.integers(0, 252), error=st.integers(0, 255), data=DATA, noise=DATA)
@example(id=1, error=0, data=b"\xff\xff\xfd\xfd\xff\xff\xfd", noise=b"")
@searches(200, 4000)
def test_answers_are_understood_as_by_the_oracle(id: int, error: int, data: bytes, noise: bytes) -> None:
    packet = Packet(id, STATUS, bytes((error,)) + data)
    read, result = HANDLER.rxPacket(FakePort(packet.encode()), False)
    end = int.from_bytes(bytes(read[5:7]), "little") + 5
    assert (result, read[4], bytes(read[8:end])) == (COMM_SUCCESS, id, packet.parameters)
    reader = PacketReader()
    assert (reader.feed(noise + packet.encode()) + reader.rest())[-1:] == [packet]


@given(packets=st.lists(DATA, min_size=1, max_size=5), cuts=st.lists(st.integers(0, 200)))
@searches(100, 4000)
def test_packets_come_in_pieces(packets: list[bytes], cuts: list[int]) -> None:
    sent = [Packet(id, STATUS, b"\0" + data) for id, data in enumerate(packets)]
    line = b"".join(packet.encode() for packet in sent)
    ends = sorted({min(cut, len(line)) for cut in cuts} | {len(line)})
    reader = PacketReader()
    assert [p for a, b in zip([0, *ends], ends, strict=False) for p in reader.feed(line[a:b])] == sent


@given(data=DATA, at=st.integers(0, 60), flip=st.integers(1, 255))
@searches(300, 4000)
def test_a_damaged_packet_is_none(data: bytes, at: int, flip: int) -> None:
    sent = Packet(1, STATUS, b"\0" + data).encode()
    assume(at < len(sent))
    reader = PacketReader()
    damaged = sent[:at] + bytes((sent[at] ^ flip,)) + sent[at + 1 :]
    assert reader.feed(damaged) + reader.rest() == []


@given(at=st.integers(0, len(FAST_ANSWER) - 1), flip=st.integers(1, 255))
@searches(300, 4000)
def test_of_a_damaged_common_answer_what_came_before_is_used(at: int, flip: int) -> None:
    reader = PacketReader(segment=4, parts=3)
    damaged = FAST_ANSWER[:at] + bytes((FAST_ANSWER[at] ^ flip,)) + FAST_ANSWER[at + 1 :]
    assert reader.feed(damaged) + reader.rest() == FAST_PARTS[: max(at - 8, 0) // 8]


@given(st.lists(st.sampled_from((b"\xff\xff\xfd\x00", b"\xfe", b"\x55", b"\xff\xff")) | st.binary(max_size=6)))
@searches(200, 4000)
def test_noise_ends(pieces: list[bytes]) -> None:
    reader = PacketReader(segment=4, parts=2)
    for piece in pieces:
        reader.feed(piece)
    reader.rest()

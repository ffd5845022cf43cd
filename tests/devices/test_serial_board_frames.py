"""COBS, the CRC and the reader of frames, with any bytes."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.devices.serial_board.line import MOST, FrameReader, crc16, decode_frame, encode_frame
from btlang.devices.serial_board.messages import (
    read_answer,
    read_ask_hello,
    read_command_head,
    read_commands,
    read_hello,
)
from tests.profiles import searches

messages = st.binary(min_size=1, max_size=MOST - 2)
pieces = st.lists(st.binary(max_size=400), max_size=12)


def test_crc_is_ccitt_false() -> None:
    assert crc16(b"123456789") == 0x29B1


def test_a_frame_byte_by_byte() -> None:
    crc = crc16(b"\x03\x00\x07")
    assert 0 not in (crc & 0xFF, crc >> 8)
    assert encode_frame(b"\x03\x00\x07") == bytes([2, 3, 4, 7, crc & 0xFF, crc >> 8, 0])


@searches(200, 20_000)
@given(messages)
def test_frames_are_read_back(message: bytes) -> None:
    frame = encode_frame(message)
    assert frame.index(0) == len(frame) - 1 == len(message) + 3
    assert decode_frame(frame[:-1]) == message


def test_too_long_a_message() -> None:
    encode_frame(b"\1" * (MOST - 2))
    with pytest.raises(ValueError, match="249 bytes"):
        encode_frame(b"\1" * (MOST - 1))


@searches(200, 20_000)
@given(st.lists(messages, max_size=5), st.randoms(use_true_random=False))
def test_pieces_of_any_size(sent: list[bytes], random: object) -> None:
    data = b"\0".join(encode_frame(message) for message in sent)
    reader, found, at = FrameReader(), [], 0
    while at < len(data):
        size = random.randint(1, 300)
        found += reader.feed(data[at : at + size])
        at += size
    assert found == sent
    assert reader.damaged == 0


@searches(200, 20_000)
@given(pieces, messages)
def test_any_bytes_are_no_frame_and_the_next_one_is_read(junk: list[bytes], message: bytes) -> None:
    reader = FrameReader()
    for piece in junk:
        for found in reader.feed(piece):  # by chance of the CRC: then it is whole, and read without an exception
            assert encode_frame(found).rstrip(b"\0") in b"".join(junk)
    assert len(reader._rest) <= MOST + 2
    reader.feed(b"\0")
    assert reader.feed(encode_frame(message)) == [message]


@searches(300, 20_000)
@given(messages, st.integers(0, 10_000), st.integers(1, 255))
def test_a_frame_with_one_wrong_byte_is_refused(message: bytes, place: int, change: int) -> None:
    """One of two bytes or more in 65,536 isn't."""
    frame = bytearray(encode_frame(message))
    frame[place % len(frame)] ^= change
    assert FrameReader().feed(bytes(frame) + b"\0") in ([], [message])  # where a zero more was added at its end


@searches(200, 20_000)
@given(st.sampled_from([0x01, 0x02, 0x03, 0x81, 0x82]), st.binary(max_size=MOST))
def test_messages_of_any_bytes(kind: int, data: bytes) -> None:
    for read in (read_answer, read_hello, read_command_head, read_commands, read_ask_hello):
        read(bytes([kind]) + data)
        if data:
            read(data)

"""The two boards, in C and in Python, do the same byte for byte, on a clock that tests drive."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from random import Random

import pytest

from btlang.devices.serial_board.line import decode_frame, encode_frame
from btlang.devices.serial_board.messages import (
    COMMANDS,
    STOP,
    BoardCommands,
    Hello,
    ask_hello,
    command_message,
    read_hello,
)
from btlang.devices.serial_board.simulated_board import CHANNELS, SILENCE
from tests.devices.boards import FIRMWARE, SHIM, STRICT, FirmwareBoard, TestBoard
from tests.profiles import amount

PAGE = Path(__file__).parents[2] / "docs" / "serial-board.md"
SESSION = 7
Board = TestBoard | FirmwareBoard


def shown_frames() -> list[tuple[int, str, bytes]]:
    """Those of the example in the page: milliseconds, direction, bytes."""
    text = PAGE.read_text(encoding="utf-8").rpartition("```text\n")[2].partition("```")[0]
    lines = re.sub(r"\n {8}(?=\S)", " ", text).splitlines()
    found = [(int(line[:5]), line[6], bytes.fromhex(line[8:])) for line in lines]
    assert len(found) == 11
    return found


def asked(board: Board, message: bytes, now: float = 0.0) -> bytes:
    return board.receive(encode_frame(message), now)


def drive(left: float, right: float) -> tuple[int, str, bytes]:
    return 2, "drive", COMMANDS["drive"].pack(COMMANDS["drive"].unpack(bytes(4)).replace(left=left, right=right))


def test_frames_of_the_page(board: Board) -> None:
    answered = b""
    for milliseconds, direction, frame in shown_frames():
        if direction == ">":
            assert answered == b""
            board.turn(milliseconds / 1000)
            answered = board.receive(frame, milliseconds / 1000)
        else:
            assert answered == frame
            answered = b""
    assert answered == b""  # a stop has no answer
    assert board.speeds == (0.0, 0.0)


def test_hello(board: Board) -> None:
    def hello(session: int) -> Hello | None:
        frame = asked(board, ask_hello(session))
        return read_hello(decode(frame))

    assert hello(0) == Hello(1, "base", 0, 0, CHANNELS)
    assert hello(5) == Hello(1, "base", 5, 0, CHANNELS)
    assert hello(0) == Hello(1, "base", 5, 5, CHANNELS)  # only asked
    assert hello(6) == Hello(1, "base", 6, 5, CHANNELS)
    board.reset(0.0)
    assert hello(7) == Hello(1, "base", 7, 0, CHANNELS)


def decode(frame: bytes) -> bytes:
    message = decode_frame(frame[:-1])
    assert message is not None
    return message


def test_motors_stop_alone(board: Board) -> None:
    """Heartbeats don't keep them turning, nor do half frames, nor a command to something else."""
    asked(board, ask_hello(SESSION))
    light, faster = (7, "light", bytes(3)), command_message(BoardCommands(SESSION, 9, (drive(0.3, 0.3),)))
    for sequence, commands in enumerate([(), (light,)]):
        start = float(sequence)
        asked(board, command_message(BoardCommands(SESSION, sequence, (drive(0.3, -0.2),))), start)
        assert board.speeds == (0.3, -0.2)
        for milliseconds in range(0, round(SILENCE * 1000), 20):
            board.turn(start + milliseconds / 1000)
            asked(board, command_message(BoardCommands(SESSION, 50, commands)), start + milliseconds / 1000)
            board.receive(encode_frame(faster)[:-3] + b"\0", start + 0.1)
        board.turn(start + SILENCE - 0.001)
        assert board.speeds == (0.3, -0.2)
        board.turn(start + SILENCE + 0.001)
        assert board.speeds == (0.0, 0.0)


@pytest.mark.parametrize("message", [bytes([STOP]), ask_hello(SESSION + 1)], ids=["stop", "new session"])
def test_what_brings_it_to_rest_at_once(board: Board, message: bytes) -> None:
    asked(board, ask_hello(SESSION))
    asked(board, command_message(BoardCommands(SESSION, 1, (drive(0.3, 0.3),))))
    assert board.speeds == (0.3, 0.3)
    asked(board, message)
    assert board.speeds == (0.0, 0.0)


@pytest.mark.parametrize(
    "message",
    [
        command_message(BoardCommands(SESSION, 1, (drive(0.3, 0.3), (9, "light", bytes(3))))),
        command_message(BoardCommands(SESSION, 1, (drive(0.3, 0.3), (6, "light", bytes(3))))),
        command_message(BoardCommands(SESSION, 1, (drive(0.3, 0.3),))) + b"\x07",
        command_message(BoardCommands(SESSION, 1, (drive(0.3, 0.3),))) + b"\x07\x07\x01\x02",
        command_message(BoardCommands(SESSION, 1, (drive(0.3, 0.3),))) + b"\x01\x01",
        bytes([0x82]) + bytes(20),
        bytes([0x44]),
        ask_hello(3)[:-1],
        bytes([STOP, 0]),
    ],
)
def test_what_does_not_fit_is_not_obeyed_at_all(board: Board, message: bytes) -> None:
    asked(board, ask_hello(SESSION))
    assert asked(board, message) == b""
    assert board.speeds == (0.0, 0.0)


def test_another_session_is_not_obeyed(board: Board) -> None:
    for session in (0, SESSION + 1):
        assert asked(board, command_message(BoardCommands(session, 1, (drive(0.3, 0.3),))))
        assert board.speeds == (0.0, 0.0)


def noise(random: Random) -> bytes:
    """Anything that may come along a line."""
    whole = [
        ask_hello(random.choice([0, SESSION])),
        command_message(BoardCommands(SESSION, random.randrange(2**16), ())),
        command_message(
            BoardCommands(SESSION, 3, (drive(random.uniform(-1, 1), 0.0), (7, "light", random.randbytes(3))))
        ),
        command_message(BoardCommands(SESSION, 4, ((8, "display", b"hello".ljust(32, b"\0")), (6, "joint", bytes(7))))),
        bytes([STOP]),
        random.choice([b"\x01", b"\x02", b"\x03", b""]) + random.randbytes(random.randrange(1, 245)),
    ]
    frame = bytearray(encode_frame(random.choice(whole)))
    fault = random.randrange(5)
    if fault == 0:
        frame[random.randrange(len(frame))] = random.randrange(256)
    elif fault == 1:
        del frame[random.randrange(len(frame)) :]
    elif fault == 2:
        frame += random.randbytes(random.randrange(600))
    return bytes(frame)


def test_both_boards_answer_the_same(firmware: Path) -> None:
    random = Random(21)
    boards = TestBoard("base"), FirmwareBoard(firmware, "base")
    answers = 0
    for _ in range(amount(1_500, 100_000)):
        data = noise(random)
        first, second = (board.receive(data, 0.0) for board in boards)
        assert first == second
        assert boards[0].speeds == boards[1].speeds
        answers += bool(first)
    assert answers > 300


def test_no_bytes_make_the_firmware_leave_its_memory(tmp_path: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    program = tmp_path / "board"
    sources = [str(FIRMWARE / "btlang_board.c"), str(SHIM), str(SHIM.with_name("board_main.c"))]
    checks = ["-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    made = subprocess.run(
        [compiler, *STRICT, *checks, f"-I{FIRMWARE}", *sources, "-o", str(program)], capture_output=True, check=False
    )
    if made.returncode:
        pytest.skip("the compiler has no sanitizers")
    random = Random(22)
    data = b"".join(noise(random) for _ in range(amount(2_000, 50_000)))
    done = subprocess.run([program], input=data, capture_output=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr.decode()
    assert len(done.stdout) > 1000


def test_the_library_and_the_sketch_compile(tmp_path: Path) -> None:
    c, cpp = shutil.which("cc"), shutil.which("c++")
    if c is None or cpp is None:
        pytest.skip("no C compiler")
    library = FIRMWARE / "btlang_board.c"
    subprocess.run([c, *STRICT, "-Wconversion", "-c", str(library), "-o", str(tmp_path / "board.o")], check=True)
    sketch = ["-x", "c++", "-std=c++11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
    stub = str(SHIM.with_name("arduino_stub.h"))
    subprocess.run([cpp, *sketch, "-include", stub, str(FIRMWARE / "firmware.ino")], check=True)

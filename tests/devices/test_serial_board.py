"""The driver of boards when all is well, and what it says where its robot file or its port isn't."""

from __future__ import annotations

import math
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import (
    Charge,
    Colour,
    Command,
    Distance,
    JointState,
    JointTarget,
    Motion,
    Pressed,
    Reading,
    Shown,
    Wheels,
    WheelSpeeds,
)
from btlang.devices.loop import DeviceLoop
from btlang.devices.serial_board.driver import SerialBoard
from btlang.devices.serial_board.messages import KIND_NUMBERS, BoardChannel
from btlang.devices.serial_board.simulated_board import SimulatedLine
from tests.devices.boards import PATIENCE, FirmwareBoard, TestBoard, devices, running


def until(reached: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not reached():
        assert time.monotonic() < end
        time.sleep(0.005)


def all_served(loop: DeviceLoop) -> bool:
    return not any(map(loop.silent, loop.devices))


def test_all_kinds(line: SimulatedLine) -> None:
    with running(line.path) as loop:
        assert set(loop.devices) == set(KIND_NUMBERS)
        until(lambda: all_served(loop))
        assert loop.read("range") == Distance(1.0)
        assert loop.read("drive") == Wheels(0.0, 0.0, 0.0, 0.0)
        assert loop.read("imu") == Motion(0.0, 0.0, 0.0, 9.81, 0.0)
        assert loop.read("battery") == Charge(80.0, 12.0, -1.0, 25.0, False)
        assert loop.read("button") == Pressed(False)
        assert loop.read("joint") == JointState(0.0, 0.0, 10.0, 30.0)
        assert loop.read("light") == loop.read("display") == Reading()
        line.board.set_range(math.inf)
        until(lambda: loop.silent("range") is None and loop.read("range") == Distance(math.inf))


def test_commands_reach_the_board(line: SimulatedLine) -> None:
    def shows() -> bool:
        loop.write("joint", JointTarget(20.0, 60.0))
        loop.write("display", Shown("grüß dich"))
        loop.write("light", Colour(1.0, 0.0, 0.0))
        loop.write("drive", WheelSpeeds(0.25, -0.25))
        if loop.silent("joint") or loop.silent("drive"):
            return False
        board, joint, wheels = line.board, loop.read("joint"), loop.read("drive")
        text = board.text() if isinstance(board, FirmwareBoard) else board.commands[8].text
        return (joint.position, text, wheels.right_speed) == (20.0, "grüß dich", -0.25)

    with running(line.path) as loop:
        until(shows)
        assert line.board.speeds == (0.25, -0.25)


def test_what_is_kept_is_sent_once_and_again_to_a_board_that_was_started_again(simulated: SimulatedLine) -> None:
    counted: list[int] = []
    board = simulated.board
    obey = board._obey

    def count(commands: Any, now: float) -> bool:
        counted.extend(number for number, _, _ in commands)
        return obey(commands, now)

    board._obey = count
    driver = SerialBoard(simulated.path, devices(simulated.path, "light", "drive"))
    told: Mapping[str, Command] = {"light": Colour(1.0), "drive": WheelSpeeds()}
    driver.open()
    for _ in range(5):
        driver.exchange(told)
    assert (counted.count(7), counted.count(2)) == (1, 5)
    simulated.reset()
    with pytest.raises(DeviceError, match="the board 'base' was started again"):
        driver.exchange(told)
    driver.close()
    driver.open()
    driver.exchange(told)
    driver.close()
    assert counted.count(7) == 2
    assert board.commands[7] == Colour(1.0)


def test_more_displays_than_fit_in_a_message(simulated: SimulatedLine) -> None:
    simulated.board = TestBoard("base", [BoardChannel(number, "display", 0.0) for number in range(20)])
    made = [Device(f"d{number}", "display", "serial-board", "", {"channel": number}) for number in range(20)]
    driver = SerialBoard(simulated.path, made)
    driver.open()
    for _ in range(5):
        driver.exchange({device.name: Shown(device.name) for device in made})
    driver.close()
    assert [simulated.board.commands[number] for number in range(20)] == [Shown(device.name) for device in made]


def test_too_many_motors(simulated: SimulatedLine) -> None:
    made = [Device(f"j{number}", "joint", "serial-board", "", {"channel": number}) for number in range(30)]
    driver = SerialBoard(simulated.path, made)
    with pytest.raises(DeviceError, match="the board 'base' has too many motors"):
        driver.open()
    driver.close()


def test_two_users_of_one_port(line: SimulatedLine) -> None:
    first, second = (SerialBoard(line.path, devices(line.path)) for _ in range(2))
    first.open()
    with pytest.raises(DeviceError, match=f"^{line.path} can't be opened: another program uses it$"):
        second.open()
    first.close()
    second.open()
    second.close()
    second.close()


def test_another_computer_takes_the_board(line: SimulatedLine) -> None:
    """As over a second line to it: the first one notices."""
    driver = SerialBoard(line.path, devices(line.path))
    driver.open()
    driver._session += 1
    with pytest.raises(DeviceError, match="the board 'base' serves another computer"):
        driver.exchange({})
    driver.close()


def test_the_name_that_a_board_must_have(line: SimulatedLine) -> None:
    driver = SerialBoard(line.path, devices(line.path, board="arm"))
    with pytest.raises(DeviceError, match=f"^the board at {line.path} is 'base', not 'arm'$"):
        driver.open()
    driver.close()


def test_a_name_that_would_move_the_cursor(simulated: SimulatedLine) -> None:
    simulated.board = TestBoard("\x1b[2J")
    driver = SerialBoard(simulated.path, devices(simulated.path, board="arm"))
    with pytest.raises(DeviceError, match=r"is '\?\[2J', not 'arm'"):
        driver.open()
    driver.close()


@pytest.mark.parametrize("place", ["missing", "file", "folder"])
def test_ports_that_are_none(place: str, tmp_path: Path) -> None:
    path = tmp_path / place
    if place == "file":
        path.write_text("x")
    elif place == "folder":
        path.mkdir()
    driver = SerialBoard(str(path), devices(str(path)))
    with pytest.raises(DeviceError, match=f"^{path} can't be opened: "):
        driver.open()
    driver.close()


def test_without_pyserial(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "serial", None)
    for port in ("/dev/ttyUSB0", "board base"):
        driver = SerialBoard(port, devices(port))
        with pytest.raises(DeviceError, match=r"pip install 'btlang\[serial\]'"):
            driver.open()


def test_a_closed_driver() -> None:
    driver = SerialBoard("/dev/ttyUSB0", devices("/dev/ttyUSB0"))
    driver.close()
    with pytest.raises(DeviceError, match="the port is not open"):
        driver.exchange({})


@pytest.mark.parametrize(
    ("port", "options", "message"),
    [
        ("/dev/x", {}, "the front needs its number on the board, 0 to 255. Write for example: channel = 1"),
        ("/dev/x", {"channel": 256}, "the front needs its number"),
        ("/dev/x", {"channel": True}, "the front needs its number"),
        ("/dev/x", {"channel": "1"}, "the front needs its number"),
        ("/dev/x", {"channel": 1, "frozen": 0}, "the front has frozen = 0; it takes seconds"),
        ("/dev/x", {"channel": 1, "frozen": math.inf}, "the front has frozen = inf"),
        ("/dev/x", {"channel": 1, "speed": 4}, "the front has an unknown option 'speed'. Known: channel, frozen, baud"),
        ("/dev/x", {"channel": 1, "baud": 9600.5}, "baud = 9600.5 at /dev/x; it takes a whole number"),
        ("/dev/x", {"channel": 1, "rate": 5}, "rate = 5 at /dev/x; it takes cycles a second from 12.5"),
        ("/dev/x", {"channel": 1, "board": 5}, "board = 5 at /dev/x; it takes the name of a board in quotes"),
        ("board base", {"channel": 1, "board": "arm"}, "board = arm, but the port says 'board base'"),
        ("board ", {"channel": 1}, "a board needs its port"),
        ("", {"channel": 1}, "a board needs its port"),
    ],
)
def test_options_that_cannot_be_used(port: str, options: dict[str, Any], message: str) -> None:
    with pytest.raises(DeviceError) as problem:
        SerialBoard(port, [Device("front", "range", "serial-board", port, options)])
    assert str(problem.value).startswith(message)


def test_options_that_contradict() -> None:
    def made(**options: Any) -> list[Device]:
        first = Device("front", "range", "serial-board", "x", {"channel": 1, "baud": 9600})
        return [first, Device("back", "range", "serial-board", "x", options)]

    with pytest.raises(DeviceError, match="the back says baud 1200, another device of its board 9600"):
        SerialBoard("x", made(channel=2, baud=1200))
    with pytest.raises(DeviceError, match="the back and the front have the same channel 1"):
        SerialBoard("x", made(channel=1))
    assert SerialBoard("x", made(channel=2))._board.baud == 9600


def test_the_command_that_simulates_a_board() -> None:
    program = [sys.executable, "-m", "btlang.devices.serial_board.simulated_board", "shown"]
    with subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            path = process.stdout.readline().strip()
            driver = SerialBoard(path, devices(path, board="shown"))
            driver.open()
            driver.close()
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 0
        finally:
            process.kill()

"""All that goes wrong with a board and its cable: no wrong value is used, motors come to rest, service comes back."""

from __future__ import annotations

import os
import time
from contextlib import ExitStack

import pytest

from btlang.devices.driver import DeviceError
from btlang.devices.dynamixel.fake_bus import FakeBus
from btlang.devices.kinds import Wheels, WheelSpeeds
from btlang.devices.loop import DeviceLoop
from btlang.devices.serial_board import line as line_module
from btlang.devices.serial_board.driver import SerialBoard
from btlang.devices.serial_board.messages import BoardChannel
from btlang.devices.serial_board.simulated_board import SimulatedLine
from tests.devices.boards import AT_REST, TestBoard, User, at_rest_after, devices, driven, running
from tests.profiles import amount

TIMES = amount(1, 20)
pytestmark = pytest.mark.long


def test_flipped_bytes(line: SimulatedLine) -> None:
    """One in a hundred, in both directions, for thousands of frames in a long run."""
    true = [1.0, 1.234, 2.5, 0.6, 3.999]
    with driven(line, rate=200) as user:
        user.true = set(true)
        line.flipped = 0.01
        for number in range(amount(8, 300)):
            line.board.set_range(true[number % len(true)])
            user.drive(0.1)
        assert user.served > 10
        line.flipped = 0.0
        user.until_served()


def test_cable_pulled_and_replugged_under_another_name(line: SimulatedLine, ports: list[SimulatedLine]) -> None:
    ports.append(line)
    with driven(line, port="board base") as user:
        for _ in range(TIMES):
            path, lost = line.path, time.monotonic()
            line.unplug()
            at_rest_after(line, user, lost)
            user.until(lambda: user.loop.silent("drive") and user.loop.silent("range"))
            assert user.loop.rate == 0.0
            line.plug()
            assert line.path != path
            user.until_served()


def test_no_other_terminal_gets_the_path_of_a_pulled_cable() -> None:
    """Who still opens it would write into a stranger's terminal."""
    with SimulatedLine(TestBoard("base")) as board, FakeBus([]) as bus, ExitStack() as opened:
        board.unplug()
        bus.unplug()
        for _ in range(5):
            ends = os.openpty()
            assert os.ttyname(ends[1]) not in (board.path, bus.port)
            for end in ends:
                opened.callback(os.close, end)


def test_the_way_that_was_rolled_while_the_cable_was_out_is_known(simulated: SimulatedLine) -> None:
    """The board wasn't started again, so its counters are still those of before."""
    with driven(simulated) as user:
        user.drive(0.2)
        rolled = read_wheels(user.loop)
        simulated.deaf = True
        user.until(lambda: user.loop.silent("drive"))
        simulated.deaf = False
        user.until_served()
        assert read_wheels(user.loop).left >= rolled.left


def read_wheels(loop: DeviceLoop) -> Wheels:
    wheels = loop.read("drive")
    assert isinstance(wheels, Wheels)
    return wheels


def test_reset_while_driving(line: SimulatedLine) -> None:
    """Its counters and its time begin at 0: the metres go on where they were, as the user checks at each look."""
    with driven(line) as user:
        for _ in range(TIMES):
            user.until(lambda: read_wheels(user.loop).left > 0.05)
            lost = time.monotonic()
            line.reset()
            user.until(lambda: user.loop.silent("drive"))
            assert "was started again" in str(user.loop.silent("drive"))
            assert line.still_since is None or line.still_since - lost <= AT_REST
            user.until_served()
            user.drive(0.2)


def test_slow_bus(simulated: SimulatedLine) -> None:
    """The line says 115,200 baud, and carries half of it."""
    with driven(simulated, "range", "drive", "imu", "joint", rate=200) as user:
        simulated.baud = 57_600
        user.drive(amount(1, 5))
        user.until(lambda: 10 < user.loop.rate < 80)
        user.until(user.look)


def test_no_cycles_are_asked_for_that_the_line_does_not_carry(line: SimulatedLine) -> None:
    line.baud = 57_600
    made = devices(line.path, rate=200, baud=57_600)
    driver = SerialBoard(line.path, made)
    driver.open()
    driver.close()
    assert 20 < driver.rate < 57_600 / 10 / 100


def test_line_too_slow(line: SimulatedLine) -> None:
    made = devices(line.path, baud=4_800)
    driver = SerialBoard(line.path, made)
    with pytest.raises(DeviceError, match=r"the line is too slow: 1\d\d bytes a cycle at 4800 baud are 3\.\d cycles"):
        driver.open()
    driver.close()


def test_echo(line: SimulatedLine) -> None:
    line.echo = True
    with driven(line) as user:
        user.drive(0.3)
        assert not any(user.loop.silent(name) for name in user.loop.devices)


def test_only_an_echo(simulated: SimulatedLine, monkeypatch: pytest.MonkeyPatch) -> None:
    simulated.echo = simulated.deaf = True
    assert "only an echo of what is sent comes back" in not_opened(simulated, monkeypatch)


def not_opened(line: SimulatedLine, monkeypatch: pytest.MonkeyPatch, port: str = "") -> str:
    monkeypatch.setattr(line_module, "HELLO_WAIT", 0.3)
    driver = SerialBoard(port or line.path, devices(port or line.path))
    with pytest.raises(DeviceError) as problem:
        driver.open()
    driver.close()
    return str(problem.value)


def test_frozen_sensor(line: SimulatedLine) -> None:
    """At a plausible value, while all else goes on."""
    with driven(line) as user:
        line.board.frozen = {1}
        reason = "its channel 1 of the board 'base' measures nothing new"
        user.until(lambda: user.loop.silent("range") == reason)  # on a slow machine the board may be late before that
        user.until(lambda: user.loop.silent("drive") is None)
        line.board.frozen = set()
        user.until_served()


def test_sensor_frozen_from_the_start(line: SimulatedLine) -> None:
    line.board.frozen = {1}
    with running(line.path, "range", "button") as loop:
        user = User(loop, set())  # no distance is true
        user.drives = False
        user.until(lambda: loop.silent("button") is None and "nothing new" in str(loop.silent("range")))


def test_value_that_never_changes(simulated: SimulatedLine) -> None:
    with running(simulated.path, "range", frozen=0.4) as loop:
        user = User(loop, {1.0, 1.5})
        user.drives = False
        user.until(lambda: loop.silent("range") is None)
        user.until(lambda: "has had exactly the same value for 0.4 s" in str(loop.silent("range")))
        simulated.board.set_range(1.5)
        user.until(lambda: loop.silent("range") is None)


def test_time_goes_back(line: SimulatedLine) -> None:
    line.board.ahead = 1e6
    with driven(line) as user:

        def goes_back() -> bool:
            if user.look():  # again where a busy machine lost the line in that moment: then no time is before it
                line.board.ahead -= 100.0
            return any("the time of the board 'base' goes back" in reason for reason in user.reasons)

        user.until(goes_back)
        user.until_served()


def test_answer_with_another_number(simulated: SimulatedLine) -> None:
    """Neither of the two is believed."""
    channels = [BoardChannel(1, "range", 0.02), BoardChannel(2, "drive", 0.02), BoardChannel(3, "range", 0.02)]
    simulated.board = board = TestBoard("base", channels)
    board.set_range(1.0)
    with driven(simulated, "range", "drive") as user:
        board.claims = {3: 1}
        user.until(lambda: "two channels answer with its number" in str(user.loop.silent("range")))
        user.until(lambda: user.loop.silent("drive") is None)
        board.claims = {1: 9}
        user.until(lambda: "its channel 1 answers as channel 9 of the kind range" in str(user.loop.silent("range")))
        board.claims = {}
        user.until_served()


def test_channel_of_another_kind_or_none(simulated: SimulatedLine) -> None:
    simulated.board = TestBoard("base", [BoardChannel(1, "imu", 0.02), BoardChannel(2, "drive", 0.02)])
    with running(simulated.path, "range", "drive", "battery") as loop:
        user = User(loop, set())
        user.until(lambda: loop.silent("drive") is None)
        assert loop.silent("range") == "its channel 1 of the board 'base' is of the kind imu, not range"
        assert loop.silent("battery") == "its channel 4 of the board 'base' doesn't exist"


def test_two_boards_of_one_name(
    simulated: SimulatedLine, ports: list[SimulatedLine], monkeypatch: pytest.MonkeyPatch
) -> None:
    with SimulatedLine(TestBoard("base")) as second, SimulatedLine(TestBoard("arm")) as other:
        ports += [simulated, second, other]
        paths = " and ".join(sorted([simulated.path, second.path]))
        assert not_opened(simulated, monkeypatch, "board base") == (
            f"two boards are called 'base': at {paths}. Give one another name"
        )
        assert simulated.board.speeds == second.board.speeds == (0.0, 0.0)
        with running("board base", "drive") as loop:
            user = User(loop, set())
            user.until(lambda: "two boards" in str(loop.silent("drive")))
            second.unplug()
            user.until_served()


def test_a_port_that_says_nothing_does_not_hide_the_board(
    simulated: SimulatedLine, ports: list[SimulatedLine], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(line_module, "HELLO_WAIT", 0.5)
    with ExitStack() as stack:
        mute, loud = (stack.enter_context(SimulatedLine(TestBoard(name))) for name in ("mute", "loud"))
        mute.deaf, loud.noise = True, b"\x55" * 500
        ports += [mute, loud, simulated]
        with driven(simulated, port="board base"):
            pass


def test_no_board_of_that_name(
    simulated: SimulatedLine, ports: list[SimulatedLine], monkeypatch: pytest.MonkeyPatch
) -> None:
    ports.append(simulated)
    assert not_opened(simulated, monkeypatch, "board arm") == (
        f"no board called 'arm' answers (found: 'base' at {simulated.path})"
    )


def test_garbage_for_ever(simulated: SimulatedLine, monkeypatch: pytest.MonkeyPatch) -> None:
    with driven(simulated) as user:
        simulated.deaf, simulated.noise = True, bytes(range(1, 40)) + b"\0"
        lost = time.monotonic()
        at_rest_after(simulated, user, lost)
        user.until(lambda: user.loop.silent("drive") and user.loop.silent("range"))
        simulated.deaf, simulated.noise = False, b""
        user.until_served()
    simulated.deaf, simulated.noise = True, b"what?" * 3 + b"\0"
    assert "are no frames (is the baud rate right?)" in not_opened(simulated, monkeypatch)


def test_garbage_between_frames(simulated: SimulatedLine) -> None:
    with driven(simulated) as user:
        simulated.noise = b"debug: x = 3\r\n\0"
        user.drive(0.3)
        user.until_served()


def test_flood(line: SimulatedLine) -> None:
    """The port is closed for a moment, so it costs little, and the reason is shown."""
    with driven(line) as user:
        line.noise = b"\x11" * 3000
        user.until(lambda: "is flooded" in str(user.loop.silent("drive")))
        at_rest_after(line, user, time.monotonic())
        assert user.loop.silent("range")
        line.noise = b""
        user.until_served()


def test_half_frames(line: SimulatedLine) -> None:
    with driven(line) as user:
        line.cut = 0.5
        user.drive(0.3)
        user.until_served()
        line.cut, lost = 1.0, time.monotonic()
        at_rest_after(line, user, lost)  # nobody drives blind
        user.until(lambda: user.loop.silent("drive") and user.loop.silent("range"))
        line.cut = 0.0
        user.until_served()


def test_newer_version(simulated: SimulatedLine, monkeypatch: pytest.MonkeyPatch) -> None:
    simulated.board = TestBoard("base", version=2)
    assert not_opened(simulated, monkeypatch) == (
        f"the board 'base' at {simulated.path} speaks version 2 of the protocol, btlang version 1. Update btlang"
    )
    simulated.board = TestBoard("base", version=0)
    assert not_opened(simulated, monkeypatch).endswith("Update the firmware of the board")


def test_silent_user(line: SimulatedLine) -> None:
    """The wheels come to rest though the line is well."""
    with driven(line) as user:
        for _ in range(TIMES):
            user.drives, lost = False, time.monotonic()
            at_rest_after(line, user, lost)
            assert user.loop.silent("drive") is None
            user.drives = True
            user.until_served()


def test_closed_while_driving(line: SimulatedLine) -> None:
    with driven(line) as user:
        user.loop.write("drive", WheelSpeeds(0.4, 0.4))
        began = time.monotonic()
        user.loop.close()
        user.until(lambda: line.still_since is not None)
        assert line.still_since - began <= AT_REST
        assert user.loop.silent("drive") == "its loop is closed"

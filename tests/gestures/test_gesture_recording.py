"""Poses of loose servos become a gesture: a simulated bus stands in for the robot that somebody moves by hand."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.fake_bus import FakeBus, FakeServo
from btlang.devices.dynamixel.protocol import PING
from tests.devices.dynamixel_rig import PATIENCE, degrees

ARM = """name = "arm"
radius = 0.2
over = "devices"
"""
JOINT = """
[[joints]]
name = "{name}"
part = "arm"
low = -90
high = {high}
speed = 60
[[device]]
name = "{name}"
kind = "joint"
driver = "dynamixel"
port = "{port}"
options = {{ id = {id} }}
"""


class Hand:
    """Moves the servos of a bus, presses Enter, and looks at the robot meanwhile."""

    def __init__(self, tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, *servos: FakeServo) -> None:
        self.bus, self.servos, self.folder = FakeBus(servos), servos, tmp_path
        self._capsys, self._patch = capsys, monkeypatch

    def records(self, moves: Callable[[], Iterator[str]]) -> tuple[int, str, Path]:
        """The exit code, what was said, and the file of the gesture."""
        joints = (("elbow", 90), ("wrist", 45))
        text = ARM + "".join(
            JOINT.format(name=name, high=high, port=self.bus.port, id=servo.id)
            for servo, (name, high) in zip(self.servos, joints, strict=False)
        )
        (self.folder / "robot.toml").write_text(text)
        path = self.folder / "peek.toml"
        self._patch.setattr("sys.stdin", moves())
        words = ["gesture", "record", "peek", "-o", str(path), "--robot", str(self.folder / "robot.toml")]
        with self.bus:
            code = main(words)
        found = self._capsys.readouterr()
        return code, found.out + found.err, path


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Servos that are silent aren't waited for that long."""
    monkeypatch.setattr("btlang.gestures.recording._WAITS", 1.5)


@pytest.fixture
def hand(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> Hand:
    return Hand(tmp_path, capsys, monkeypatch, FakeServo(1), FakeServo(2))


def turn(servo: FakeServo, to: float) -> None:
    servo.turn_to(2048 + to * 4096 / 360)


def seen(hand: Hand) -> None:
    """Waits until the robot has asked its servos some more times where they are."""
    count, end = sum(hand.bus.heard.values()), time.monotonic() + PATIENCE
    while sum(hand.bus.heard.values()) < count + 10:
        assert time.monotonic() < end
        time.sleep(0.01)


def given_up(hand: Hand) -> None:
    """Waits until the robot tries one that is silent again, which it does only after it has given up to wait for it."""
    count, end = hand.bus.heard[PING], time.monotonic() + PATIENCE
    while hand.bus.heard[PING] == count:
        assert time.monotonic() < end
        time.sleep(0.01)


def test_poses_are_where_the_joints_were(hand: Hand) -> None:
    elbow, wrist = hand.servos
    elbow.write(table.TORQUE, b"\1")
    elbow.write(table.GOAL_POSITION, (2048).to_bytes(4, "little"))

    def moves() -> Iterator[str]:
        assert not elbow.has_torque
        assert not wrist.has_torque
        for one, other in ((30.0, 0.0), (60.0, -20.0)):
            turn(elbow, one)
            turn(wrist, other)
            seen(hand)
            yield "\n"
        turn(elbow, 45.0)
        seen(hand)
        yield "end\n"

    code, said, path = hand.records(moves)
    assert code == 0, said
    frames = tomllib.loads(path.read_text())["frame"]
    assert [(frame["elbow"], frame["wrist"]) for frame in frames] == [
        (pytest.approx(30, abs=0.1), 0.0),
        (pytest.approx(60, abs=0.1), pytest.approx(-20, abs=0.1)),
    ]
    for servo, at in ((elbow, 45), (wrist, -20)):
        assert servo.has_torque
        assert degrees(servo) == pytest.approx(at, abs=0.3)
        assert servo.goal == pytest.approx(servo.position, abs=3)


def test_an_interrupt_writes_nothing_and_the_joints_hold(hand: Hand) -> None:
    elbow, _ = hand.servos

    def moves() -> Iterator[str]:
        turn(elbow, 30.0)
        seen(hand)
        yield "\n"
        turn(elbow, -10.0)
        seen(hand)
        raise KeyboardInterrupt

    code, _, path = hand.records(moves)
    assert code == 130
    assert not path.exists()
    assert elbow.has_torque
    assert degrees(elbow) == pytest.approx(-10, abs=0.3)
    assert elbow.goal == pytest.approx(elbow.position, abs=3)


@pytest.mark.usefixtures("short")
def test_a_servo_that_falls_silent_is_named(hand: Hand) -> None:
    elbow, wrist = hand.servos

    def moves() -> Iterator[str]:
        turn(elbow, 30.0)
        seen(hand)
        yield "\n"
        wrist.silent = True
        given_up(hand)
        yield "\n"
        yield "end\n"

    code, text, path = hand.records(moves)
    assert code == 0
    assert "the wrist is silent: servo 2 on" in text
    assert "The wrist can't be told to hold its place." in text
    assert elbow.has_torque
    assert len(tomllib.loads(path.read_text())["frame"]) == 1


@pytest.mark.usefixtures("short")
def test_a_bus_that_is_silent_from_the_start_is_an_error(hand: Hand) -> None:
    for servo in hand.servos:
        servo.silent = True
    code, said, path = hand.records(lambda: iter(["\n"]))
    assert code == 2
    assert "error BT071" in said
    assert "servo 1 on" in said
    assert not path.exists()


def test_a_pose_beyond_the_limits_is_refused(hand: Hand) -> None:
    _, wrist = hand.servos

    def moves() -> Iterator[str]:
        turn(wrist, 45.4)
        seen(hand)
        yield "\n"
        turn(wrist, 60.0)
        seen(hand)
        yield "\n"
        turn(wrist, 10.0)
        seen(hand)
        yield "end\n"

    code, said, path = hand.records(moves)
    assert code == 0
    assert "the wrist is at 59.9" in said or "the wrist is at 60" in said
    assert [frame["wrist"] for frame in tomllib.loads(path.read_text())["frame"]] == [45.0]

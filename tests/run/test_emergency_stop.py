"""The emergency stop: the robot stops at once, whatever a leaf is doing, and then the run ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang import Session
from btlang.engine.status import IDLE, RUNNING, SUCCESS
from btlang.run.events import PeriodPassed, StatusesChanged
from tests.trial import Trial

REPOSITORY = Path(__file__).parent.parent.parent
PATIENCE = 20.0  # seconds of real time, for what takes none


class Hanging:
    """A command that drives off, and at its tenth tick hangs until it is released; then it commands all it can."""

    def __init__(self) -> None:
        self.entered, self.released = threading.Event(), threading.Event()

        @btlang.action("charge ahead")
        def charge_ahead(robot: Any) -> Iterator[None]:
            robot.drive(1.0, 0.0)
            for _ in range(10):
                yield
            self.entered.set()
            assert self.released.wait(PATIENCE)
            robot.drive(1.0, 90.0)
            robot.navigate_to("kitchen")
            robot.move_joints({"head turn": 90.0})
            robot.release("right")
            robot.drive(1.0, 90.0)
            while True:
                yield

        self.tree = Trial("pick up the cup then charge ahead", keywords=[charge_ahead])


def test_the_robot_stops_before_a_hanging_leaf_returns() -> None:
    hanging = Hanging()
    tree, outcomes = hanging.tree, []
    thread = threading.Thread(target=lambda: outcomes.append(tree.run(speed="max")))
    thread.start()
    assert hanging.entered.wait(PATIENCE)
    robot = tree.robot
    assert (robot.moving, robot.stops) == (True, 0)
    tree.controls.emergency_stop()
    assert robot.stops == 1
    assert thread.is_alive()
    place, facing = robot.pose, robot.pose.heading
    hanging.released.set()
    thread.join(PATIENCE)
    [outcome] = outcomes
    assert (outcome.status, outcome.stopped, outcome.failure) == (IDLE, "emergency stop", None)
    assert place.distance_to((robot.pose.x, robot.pose.y)) < 0.05  # what the brakes need from 0.5 m/s
    assert robot.pose.heading == pytest.approx(facing)
    assert (robot.moving, robot.joint("head turn"), robot.holding("right")) == (False, 0.0, "cup")


def test_the_tree_is_halted_as_in_an_emergency(monkeypatch: pytest.MonkeyPatch) -> None:
    from btlang.engine.engine import Engine

    halts: list[bool] = []
    halt = Engine.halt
    monkeypatch.setattr(
        Engine, "halt", lambda self, emergency=False: (halts.append(emergency), halt(self, emergency=emergency))
    )
    tree = Trial("move forward 2 m")
    tree.run(speed="max", sinks=[lambda event: tree.controls.stop() if event.t > 1 else None])
    tree.run(speed="max", sinks=[lambda event: tree.controls.emergency_stop() if event.t > 1 else None])
    assert halts == [False, True]


def test_nothing_is_ticked_after_it() -> None:
    ticked: list[int] = []

    @btlang.action("count")
    def count(robot: Any) -> Iterator[None]:
        while True:
            ticked.append(robot.stops)
            if len(ticked) == 5:
                tree.controls.emergency_stop()
            yield

    tree = Trial("count", keywords=[count])
    outcome = tree.run(speed="max")
    assert (outcome.stopped, outcome.ticks, ticked) == ("emergency stop", 5, [0] * 5)


def test_while_the_run_is_paused() -> None:
    tree = Trial("go to the lab")

    def watch(event: object) -> None:
        if isinstance(event, PeriodPassed) and event.t >= 2:
            if tree.controls.paused:
                tree.controls.emergency_stop()
            tree.controls.pause()

    outcome = tree.run(speed="max", sinks=[watch])
    assert (outcome.stopped, tree.robot.moving) == ("emergency stop", False)


def test_while_the_robot_comes_to_rest() -> None:
    tree = Trial("wave")
    over: list[object] = []

    def watch(event: object) -> None:
        if isinstance(event, StatusesChanged):
            over.extend(change for change in event if change.path == "/" and change.status == SUCCESS)
        elif over and isinstance(event, PeriodPassed):
            tree.controls.emergency_stop()

    outcome = tree.run(speed="max", sinks=[watch])
    assert (outcome.status, outcome.stopped) == (IDLE, "emergency stop")


def test_without_a_run_the_robot_stops_and_the_next_run_does_not_begin() -> None:
    session = Session()
    tree = Trial("move forward 1 m", session)
    tree.controls.robot = session.robot
    session.robot.drive(0.5, 0.0)
    session.robot.step(1.0)
    tree.controls.emergency_stop()
    assert session.robot.stops == 1
    outcome = tree.run(speed="max")
    assert (outcome.stopped, outcome.ticks, session.robot.moving) == ("emergency stop", 0, False)
    assert tree.run(speed="max").status == SUCCESS


def test_between_ticks_by_hand() -> None:
    tree = Trial("move forward 1 m")
    for _ in range(20):
        assert tree.tick() == RUNNING
    tree.controls.emergency_stop()
    assert tree.tick() == IDLE
    assert not tree.robot.moving
    assert tree.tick() == RUNNING  # anew
    tree.run(speed="max", time_limit=1)
    assert tree.tick() == RUNNING
    tree.controls.emergency_stop()
    assert tree.tick() == IDLE


def test_a_stop_in_the_middle_of_a_step_is_not_overwritten(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Session().robot
    robot.drive(0.5, 0.0)
    robot.step(1.0)
    pieces: list[int] = []

    def between() -> None:
        pieces.append(0)
        if len(pieces) == 2:
            robot.stop()
            robot._base.drive(0.5, 0.0)  # as the journey under way in another thread would have

    monkeypatch.setattr(robot, "_begin_faults", between)
    robot.step(1.0)
    assert len(pieces) == 20
    assert not robot.moving


HANGING = """
import hashlib, threading, time

def hang(robot):
    seen = []

    def watch():
        while not robot.stops:
            time.sleep(0.002)
        seen.append("stopped")

    threading.Thread(target=watch, daemon=True).start()
    print("hangs", flush=True)
    hashlib.pbkdf2_hmac("sha256", b"", b"", 4_000_000)  # no handler of a signal runs in here
    print("returned after", seen, flush=True)
    robot.drive(1, 0)
    yield
"""


@pytest.mark.skipif(not hasattr(signal, "SIGQUIT"), reason="the system has no such signal")
def test_the_signal_stops_the_robot_of_the_command(tmp_path: Path) -> None:
    (tmp_path / "hanging.py").write_text(HANGING)
    words = tmp_path / "words.toml"
    words.write_text('[[action]]\nphrase = "hang"\nid = "Hang"\ncall = "hanging:hang"\n')
    command = [
        sys.executable,
        "-m",
        "btlang",
        "run",
        "-c",
        "wait 1 s then hang",
        "--speed",
        "5",
        "--keywords",
        str(words),
    ]
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
    with subprocess.Popen(
        command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert any("hangs" in line for line in process.stdout)
        process.send_signal(signal.SIGQUIT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (131, ""), out
    lines = out.splitlines()
    assert "returned after ['stopped']" in out
    assert lines[-1].startswith("Emergency stop after 1.")
    assert lines[-1].endswith(" s; the robot stands still.")


@pytest.mark.parametrize(("name", "code"), [("SIGTERM", 143), ("SIGQUIT", 131)])
def test_a_signal_ends_the_command_that_does_not_end_by_itself(name: str, code: int, tmp_path: Path) -> None:
    """As where the main thread is in code that isn't Python's: only real time counts."""
    (tmp_path / "hanging.py").write_text(HANGING.replace("4_000_000", "400_000_000"))
    words = tmp_path / "words.toml"
    words.write_text('[[action]]\nphrase = "hang"\nid = "Hang"\ncall = "hanging:hang"\n')
    program = (
        "import sys; from btlang import cli; from btlang.run import terminal; terminal.PATIENCE = 0.5;"
        f" sys.exit(cli.main(['run', '-c', 'hang', '--keywords', {str(words)!r}]))"
    )
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
    with subprocess.Popen(
        [sys.executable, "-c", program], env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert any("hangs" in line for line in process.stdout)
        time.sleep(0.3)  # until the main thread is in there
        process.send_signal(getattr(signal, name))
        _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (code, "The mission didn't end when it was asked to: the robot was stopped.\n")


GOES_ON = """
import signal, time
from btlang.run.controls import emergency_signal
began = time.monotonic()
tell = lambda what: print(what, round(time.monotonic() - began, 1), flush=True)
signal.signal(signal.SIGTERM, lambda *_: tell("told"))
with emergency_signal(lambda: tell("stop"), lambda: tell("disable"), 1.0):
    print("ready", flush=True)
    while True:
        time.sleep(0.1)
"""


@pytest.mark.parametrize(
    ("name", "code", "said"),
    [("SIGTERM", 143, ["told", "disable", "stop"]), ("SIGQUIT", -9, ["stop"])],
)
def test_what_does_not_end_is_stopped_and_then_ended(name: str, code: int, said: list[str]) -> None:
    r"""As a robot with tasks that hangs at its end; Ctrl-\ stops it, and doesn't end it."""
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
    with subprocess.Popen(
        [sys.executable, "-c", GOES_ON], env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(getattr(signal, name))
        if code < 0:
            time.sleep(1.5)
            process.kill()
        lines = process.stdout.read().splitlines()
        assert process.wait(PATIENCE) == code
    assert [line.split()[0] for line in lines] == said

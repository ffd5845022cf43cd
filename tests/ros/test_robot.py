"""Missions on a ROS 2 robot in another process: they do what they say, and end with a reason where they cannot."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist

from btlang.cli import main
from tests.profiles import cases
from tests.ros.client import Client
from tests.ros.processes import LONG, REPOSITORY, Command, start, wait_until


class Script:
    """A scripted robot (see scripted_robot.py) and what it was told."""

    def __init__(self, folder: Path, domain: int, *parts: str) -> None:
        self._out = folder / "robot.txt"
        environment = {**os.environ, "PYTHONPATH": str(REPOSITORY), "ROS_DOMAIN_ID": str(domain)}
        with self._out.open("w") as out:
            self.process = start(
                sys.executable,
                "-m",
                "tests.ros.scripted_robot",
                *parts,
                env=environment,
                stdin=subprocess.PIPE,  # it ends when this is closed
                stdout=out,
            )
        self.wait_for("ready")

    @property
    def lines(self) -> list[str]:
        return self._out.read_text().splitlines()

    def wait_for(self, line: str) -> None:
        """Until it has printed this line, or one that begins so."""
        wait_until(lambda: any(said.startswith(line) for said in self.lines), f"'{line}' printed by the robot")

    @property
    def place(self) -> float:
        """Where the base was when it was last told to do something else: metres along its way."""
        return float(self.drives[-1].split()[-1])

    @property
    def drives(self) -> list[str]:
        return [line for line in self.lines if line.startswith("drive ")]

    def kill(self) -> None:
        self.process.kill()
        self.process.communicate()


@pytest.fixture
def robot(tmp_path: Path, domain: int) -> Iterator[Callable[..., Script]]:
    """Starts a scripted robot."""
    started: list[Script] = []

    def start(*parts: str) -> Script:
        folder = tmp_path / f"robot{len(started)}"
        folder.mkdir()
        started.append(Script(folder, domain, *parts))
        return started[-1]

    yield start
    for script in started:
        script.kill()


@pytest.fixture
def btc(tmp_path: Path, domain: int) -> Iterator[Callable[..., Command]]:
    """Starts `btc run --robot ros` with a mission; it has to be over when the test is."""
    started: list[Command] = []

    def start(mission: str, *options: str) -> Command:
        folder = tmp_path / f"btc{len(started)}"
        folder.mkdir()
        started.append(Command(folder, domain, "run", "--robot", "ros", "-c", mission, *options))
        return started[-1]

    yield start
    for command in started:
        command.process.kill()
        command.process.wait()


def code_of(command: Command, seconds: float = LONG) -> int:
    """Its exit code; it told no traceback."""
    code = command.process.wait(seconds)
    assert "Traceback" not in command.err + command.out
    return code


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(domain: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """The same in this process, as it is quicker; the exit code, the output and the errors."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))

    def done(mission: str, *options: str) -> tuple[int, str, str]:
        code = main(["run", "--robot", "ros", "-c", mission, *options])
        return code, *capsys.readouterr()

    return done


@pytest.mark.parametrize("base", ["base", "base=stamped"])
def test_a_robot_moves_as_far_as_it_is_told(
    base: str, robot: Callable[..., Script], btc: Callable[..., Command]
) -> None:
    script = robot(base)
    command = btc("move forward 1 meter")
    assert code_of(command) == 0, command.err
    assert script.drives[-1].startswith("drive 0.000 0.000")
    assert script.place == pytest.approx(1.0, abs=0.03)
    assert "The mission succeeded in " in command.out


def test_turning(robot: Callable[..., Script], run: Run) -> None:
    robot("base")
    code, _, err = run("turn left 90 degrees then turn right 45 degrees then stop")
    assert code == 0, err


@cases(
    ("parts", "mission", "reason"),
    [
        (["base=mute"], "move forward 1 m", "MoveForward: no odometry for 2 s: /odom is silent"),
        (["base=frozen"], "move forward 1 m", "MoveForward: stuck after 0.00 m"),
        (
            ["base", "navigation=reject"],
            "go to the kitchen",
            "GoTo: the navigation server refused to navigate to the k",
        ),
        (["base", "navigation=abort"], "go to the kitchen", "GoTo: the door is shut"),
        (["base", "navigation=mute"], "go to the kitchen", "GoTo: the navigation server on /navigate_to_pose does not"),
        (["base", "navigation=hang"], "go to the kitchen", "GoTo: no feedback from the navigation server on /navigate"),
        (["hand=full"], "close the hand", "CloseHand: the right hand already holds the cup"),
        (["hand=mute"], "close the hand", "CloseHand: no answer from /right_hand/close for 3 s"),
    ],
    4,
)
def test_what_goes_wrong_is_a_failure_with_its_reason(
    parts: list[str],
    mission: str,
    reason: str,
    robot: Callable[..., Script],
    run: Run,
    nav2: object,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("btlang.ros.robot.navigation._ANSWER", 2.0)
    script = robot(*parts)
    code, _, err = run(mission)
    assert code == 1
    assert reason in err
    if "base=mute" in parts:
        assert script.drives[-1].startswith("drive 0.000 0.000")


def test_a_service_that_does_not_answer_costs_the_tick_nothing(robot: Callable[..., Script], run: Run) -> None:
    robot("hand=mute")
    code, _, err = run("close the hand within 1 second")
    assert code == 1
    assert "Timeout: took longer than 1 s" in err


def test_a_journey_arrives(robot: Callable[..., Script], run: Run, nav2: object) -> None:
    script = robot("base", "navigation=arrive")
    code, _, err = run("go to the kitchen")
    assert code == 0, err
    assert "cancel" not in script.lines


def test_a_success_far_from_the_goal_is_none(robot: Callable[..., Script], run: Run, nav2: object) -> None:
    robot("base", "navigation=lie")
    code, _, err = run("go to the kitchen")
    assert code == 1
    assert re.search(r"GoTo: the navigation server reports success, but the robot is \d\.\d m from the goal", err), err


def test_a_navigation_server_that_is_killed(
    robot: Callable[..., Script], btc: Callable[..., Command], nav2: object
) -> None:
    robot("base")
    server = robot("navigation=hang")
    command = btc("go to the kitchen")
    server.wait_for("accepted")
    server.kill()
    assert code_of(command, 40) == 1
    assert re.search(
        r"GoTo: .*the navigation server on /navigate_to_pose (is gone|for 5 s|sends no feedback)", command.err
    )


def test_a_base_that_is_killed(robot: Callable[..., Script], btc: Callable[..., Command]) -> None:
    script = robot("base")
    command = btc("move forward 9 m")
    script.wait_for("drive 0.5")
    script.kill()
    assert code_of(command) == 1
    assert "MoveForward: no odometry for 2 s: /odom is silent" in command.err


@pytest.mark.parametrize(("manner", "when"), [("slow", "goal"), ("hang", "accepted")])
def test_a_goal_is_cancelled_when_the_mission_is(
    manner: str, when: str, robot: Callable[..., Script], btc: Callable[..., Command], nav2: object
) -> None:
    """Also one that is not accepted yet."""
    script = robot("base", f"navigation={manner}")
    command = btc("go to the kitchen")
    script.wait_for(when)
    command.process.send_signal(signal.SIGINT)
    assert code_of(command) == 130
    script.wait_for("cancelled")


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGQUIT, 131)]
)
def test_a_signal_leaves_the_robot_at_rest(
    number: signal.Signals, code: int, robot: Callable[..., Script], btc: Callable[..., Command]
) -> None:
    script = robot("base")
    command = btc("move forward 9 m")
    script.wait_for("drive 0.5")
    command.process.send_signal(number)
    assert code_of(command) == code
    wait_until(lambda: script.drives[-1].startswith("drive 0.000 0.000"), "zero velocity", 1.0)
    assert script.place < 3.0


def test_a_client_that_was_asleep_says_so_and_blames_nobody(
    robot: Callable[..., Script], btc: Callable[..., Command]
) -> None:
    script = robot("base")
    command = btc("move forward 99 m")
    script.wait_for("drive 0.5")
    command.process.send_signal(signal.SIGSTOP)
    time.sleep(3.0)  # longer than odometry may be silent
    command.process.send_signal(signal.SIGCONT)
    command.wait_for("warning this computer was asleep for 3 s, or btlang was suspended")
    began = time.monotonic()
    wait_until(lambda: time.monotonic() > began + 0.5 or command.process.poll() is not None, "some more ticks")
    command.process.send_signal(signal.SIGINT)
    assert code_of(command) == 130, command.err
    assert script.drives[-1].startswith("drive 0.000 0.000")


def test_a_time_limit_leaves_the_robot_at_rest(robot: Callable[..., Script], btc: Callable[..., Command]) -> None:
    script = robot("base")
    assert code_of(btc("move forward 9 m", "--for", "1s")) == 0
    assert script.drives[-1].startswith("drive 0.000 0.000")
    assert 0.2 < script.place < 0.8


def test_what_is_missing_is_told_before_the_run(btc: Callable[..., Command], nav2: object) -> None:
    command = btc("move forward then go to the kitchen")
    assert code_of(command) == 2  # within its time limit: 7 s of discovery happen once
    assert "error BT101: 'move forward' needs the topic /cmd_vel, but nobody listens to /cmd_vel." in command.err
    assert "error BT101: 'move forward' needs the topic /odom, but nobody publishes /odom." in command.err
    assert (
        "error BT101: 'go to the kitchen' needs the action /navigate_to_pose, but there is no action server "
        in command.err
    )


def test_preflight(
    robot: Callable[..., Script],
    btc: Callable[..., Command],
    run: Run,
    client: Client,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    script = robot("base", "speech")
    monkeypatch.setattr("btlang.ros.robot.connection._DISCOVERY", 3.0)  # nodes of tests announce themselves every 0.1 s
    code, out, _ = run("move forward until there is a wall in front", "--preflight")
    assert code == 1
    assert re.search(r"^topic   /scan +sensor_msgs/msg/LaserScan +missing: nobody publishes /scan$", out, re.M)
    assert out.splitlines()[-1] == "Missing: 1 of 3."
    assert "warning" not in out
    client.publisher(Twist, "/cmd_vel")
    ready = btc("move forward then say done", "--preflight")
    assert code_of(ready) == 0, ready.err
    assert ready.out.splitlines()[-2:] == [
        "warning: /client publishes /cmd_vel too, so the robot follows both",
        "The robot has everything that the mission needs.",
    ]
    assert script.drives == []


WORDS = '[[action]]\nphrase = "run away"\nid = "RunAway"\ncall = "running_away:run_away"\n'
RUN_AWAY = """
import threading, time

def run_away(robot):
    def drive():
        while True:
            robot.drive(0.4, 0.0)
            time.sleep(0.0005)

    for _ in range(4):
        threading.Thread(target=drive, daemon=True).start()
    while True:
        yield
"""


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGQUIT, 131)])
def test_threads_that_drive_on_do_not_have_the_last_word(
    number: signal.Signals, code: int, robot: Callable[..., Script], btc: Callable[..., Command], tmp_path: Path
) -> None:
    (tmp_path / "words.toml").write_text(WORDS)
    (tmp_path / "running_away.py").write_text(RUN_AWAY)
    script = robot("base")
    command = btc("move forward 10 cm then run away", "--keywords", str(tmp_path / "words.toml"))
    script.wait_for("drive 0.4")
    command.process.send_signal(number)
    assert code_of(command) == code
    assert "the robot stands still." in command.out
    wait_until(lambda: script.drives[-1].startswith("drive 0.000 0.000"), "zero velocity", 1.0)
    count = len(script.drives)
    zero = max(at for at, line in enumerate(script.drives) if line.startswith("drive 0.4"))
    assert count == zero + 2  # one zero after the last drive, and nothing since

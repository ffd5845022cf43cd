"""What is said of a robot at the end of a run is true: it was looked at."""

from __future__ import annotations

import json
import re
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.profiles import cases
from tests.ros.declared import Peer
from tests.ros.processes import LONG, Command

UNANSWERED = "the navigation server did not answer the cancel"
REFUSED = "the navigation server refused to cancel its goal"
UNENDED = "the navigation server did not end the cancelled goal"


@pytest.fixture
def peer(domain: int, nav2: object) -> Iterator[Callable[..., Peer]]:
    """Starts a program of tests/ros/peers."""
    started: list[Peer] = []

    def start(program: str, *arguments: str) -> Peer:
        started.append(Peer(program, *arguments, domain=domain))
        started[-1].expect("ready")
        return started[-1]

    yield start
    for each in started:
        each.close()


@pytest.fixture
def run(tmp_path: Path, domain: int) -> Iterator[Callable[..., Command]]:
    """Starts `btc run` with a mission."""
    started: list[Command] = []

    def start(mission: str, *options: str) -> Command:
        log = ("--log", str(tmp_path / "log.jsonl"))
        started.append(Command(tmp_path, domain, "run", "--robot", "ros", "-c", mission, *log, *options))
        return started[-1]

    yield start
    for each in started:
        each.process.kill()
        each.process.wait()


@cases(
    ("mode", "number", "reason"),
    [
        ("reject", signal.SIGINT, f": {REFUSED}"),
        ("ignore", signal.SIGQUIT, f": {UNANSWERED}"),
        ("linger", signal.SIGTERM, f": {UNENDED}"),
        ("lie", signal.SIGINT, ""),
    ],
    2,
)
def test_a_robot_that_is_driven_on(
    mode: str,
    number: signal.Signals,
    reason: str,
    peer: Callable[..., Peer],
    run: Callable[..., Command],
    tmp_path: Path,
) -> None:
    robot = peer("faulty_navigator", mode)
    mission = run("go to the kitchen")
    robot.expect("going")
    mission.process.send_signal(number)
    assert mission.process.wait(LONG) == 3
    told = f"the robot is still moving at 0.3 m/s{reason}"
    assert mission.err == f"WARNING: {told}.\n"
    assert "stands still" not in mission.out
    end = json.loads((tmp_path / "log.jsonl").read_text().splitlines()[-1])
    assert (end["event"], end["still"], end["motion"]) == ("end", False, told)
    robot.expect("cancel")
    for _ in range(10):  # zero velocity was kept up
        robot.expect("zero")


def test_a_server_of_actions_that_goes_on(
    peer: Callable[..., Peer], run: Callable[..., Command], run_mission: object
) -> None:
    robot = peer("faulty_navigator", "reject", "phrase")
    mission = run("move forward 9 m", "--robot", "actions")
    robot.expect("going")
    mission.process.send_signal(signal.SIGINT)
    assert mission.process.wait(LONG) == 3
    reason = "/actions/move_forward refused to cancel its goal"
    assert mission.err == f"WARNING: the robot is still moving at 0.3 m/s: {reason}.\n"


def test_a_robot_that_obeys(peer: Callable[..., Peer], run: Callable[..., Command], tmp_path: Path) -> None:
    robot = peer("faulty_navigator", "obey")
    mission = run("go to the kitchen")
    robot.expect("going")
    mission.process.send_signal(signal.SIGINT)
    assert mission.process.wait(LONG) == 130
    assert re.search(r"^Interrupted after [\d.]+ s; the robot stands still\.$", mission.out, re.M)
    assert mission.err == ""
    assert json.loads((tmp_path / "log.jsonl").read_text().splitlines()[-1])["still"] is True


def test_a_robot_of_which_nothing_is_known(
    peer: Callable[..., Peer], run: Callable[..., Command], tmp_path: Path
) -> None:
    peer("robot", "speech")
    mission = run("say hello then wait 1 minute")
    mission.wait_for("done   say")
    mission.process.send_signal(signal.SIGINT)
    assert mission.process.wait(LONG) == 130
    assert "; nothing reports whether the robot moves." in mission.out
    assert mission.err == ""
    assert json.loads((tmp_path / "log.jsonl").read_text().splitlines()[-1])["still"] is None


ASKS = """
from rclpy.publisher import Publisher

asked = Publisher.wait_for_all_acked


def ask(self, limit):
    found = asked(self, limit)
    print(self.topic_name, found, flush=True)
    return found


Publisher.wait_for_all_acked = ask
from btlang.cli import main

main(["run", "--robot", "ros", "-c", "nod", "--quiet"])
"""


class Asking(Command):
    """A mission that shows which topics have arrived as it ends."""

    program = ("-c", ASKS)


def test_the_robot_has_the_last_zero(start_sim: Callable[..., Command], domain: int, tmp_path: Path) -> None:
    """Before the program ends; without the profile of these tests, whose writers ask for it in other intervals."""
    start_sim()
    mission = Asking(tmp_path, domain, FASTRTPS_DEFAULT_PROFILES_FILE=None)
    assert mission.process.wait(LONG) == 0, mission.err
    assert "/cmd_vel True" in mission.out

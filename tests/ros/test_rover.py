"""The campus rover over ROS 2: the driver of its arm and its web page hear it, and it does as in the simulation."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from std_msgs.msg import String

from btlang.cli import main
from tests.profiles import only_long
from tests.ros.client import LATCHED, Client
from tests.ros.processes import Command

ROVER = Path(__file__).parents[2] / "examples" / "rover"
ROBOT = ["--robot", str(ROVER / "robot.toml")]
SPEED = 5  # times real time; at 20 a pause of 50 ms on a busy machine is a second of standing


@pytest.fixture(autouse=True)
def _in_domain(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))


def start(start_sim: Callable[..., Command]) -> None:
    start_sim(*ROBOT, "--world", str(ROVER / "world.toml"), "--speed", str(SPEED))


def test_its_topics(start_sim: Callable[..., Command], client: Client, capfd: pytest.CaptureFixture[str]) -> None:
    arm, state = client.hear(String, "/armcommand"), client.hear(String, "/rover_state", LATCHED)
    language = client.hear(String, "/language", LATCHED)
    start(start_sim)
    text = "set the arm to cobra then report idle then speak Spanish then say hola then set the arm to init"
    assert main(["run", *ROBOT, "--over", "ros", "--sim-time", "-c", text]) == 0, capfd.readouterr().err
    arm.wait(lambda message: message.data == "init", since=0)
    assert [message.data for message in arm.messages] == ["cobra", "init"]
    assert state.wait().data == "idle"
    language.wait(lambda message: message.data == "en", since=1)
    assert [message.data for message in language.messages] == ["es", "en"]  # the mission is over


@only_long
def test_its_patrol(
    start_sim: Callable[..., Command], client: Client, tmp_path: Path, nav2: object, capfd: pytest.CaptureFixture[str]
) -> None:
    arm, states = client.hear(String, "/armcommand"), client.hear(String, "/rover_state", LATCHED)
    start(start_sim)
    log = tmp_path / "log.json"
    patrol = str(ROVER / "missions" / "patrol.txt")
    assert main(["run", patrol, *ROBOT, "--over", "ros", "--sim-time", "--log", str(log)]) == 0, capfd.readouterr().err
    lines: list[dict[str, Any]] = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    arrived = [line["name"] for line in lines if line.get("event") == "arrive"]
    assert arrived[:4] == ["mail room", "robotics lab", "library", "kitchen"]
    states.wait(lambda message: message.data == "idle", since=0)
    assert [message.data for message in arm.messages] == ["upper", "cobra", "init"]
    assert states.messages[0].data == "navigating"  # of those that follow at once the latest counts
    assert states.messages[-1].data == "idle"

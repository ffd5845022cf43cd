"""Several robots in one domain, each in a namespace."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from nav_msgs.msg import Odometry

from tests.ros.client import Client
from tests.ros.processes import LONG, Command

SHOUT = """
[[action]]
phrase = "shout {text}"
id = "Shout"
ros.publish = "std_msgs/msg/String"
ros.name = "speech"
ros.message.data = "{text}!"
"""


def test_a_mission_is_for_the_robot_of_its_namespace(
    start_sim: Callable[..., Command], client: Client, tmp_path: Path, domain: int
):
    first, second = (start_sim("--namespace", name, "--no-clock", "--speed", "1") for name in ("robot1", "robot2"))
    odometry = {name: client.hear(Odometry, f"/{name}/odom") for name in ("robot1", "robot2")}
    began = {name: heard.wait().pose.pose.position for name, heard in odometry.items()}
    words = tmp_path / "words.toml"
    words.write_text(SHOUT, encoding="utf-8")
    absent = Command(_folder(tmp_path, "absent"), domain, "run", "-c", "nod", "--robot", "ros", "--namespace", "robot3")
    text = "shout hello then move forward 20 cm then close the hand"
    options = ["--keywords", str(words), "--robot", "ros", "--namespace", "robot2"]
    ready = Command(_folder(tmp_path, "ready"), domain, "run", "-c", text, *options, "--preflight")
    assert ready.process.wait(LONG) == 0, ready.out
    assert "topic   /robot2/cmd_vel" in ready.out
    assert "topic   /robot2/speech" in ready.out
    mission = Command(_folder(tmp_path, "mission"), domain, "run", "-c", text, *options)
    assert mission.process.wait(LONG) == 1
    assert "CloseHand: nothing is within reach of the right hand" in mission.err
    moved = {name: heard.next().pose.pose.position.y - began[name].y for name, heard in odometry.items()}
    assert moved == {"robot1": 0.0, "robot2": pytest.approx(0.2, abs=0.02)}
    assert "hello!" in second.out
    assert "hello!" not in first.out
    assert absent.process.wait(LONG) == 2
    assert "needs the topic /robot3/joint_states, but nobody publishes /robot3/joint_states" in absent.err


def _folder(path: Path, name: str) -> Path:
    (path / name).mkdir()
    return path / name

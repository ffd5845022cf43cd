"""A capability of one's own: a lift, which is a joint that slides. An entry, its function and a robot file are all."""

from __future__ import annotations

from pathlib import Path

import pytest
from sensor_msgs.msg import JointState

from btlang.cli import main
from tests.ros.client import Client

ROBOT = """
name = "forklift"
radius = 0.3

[[joints]]
name = "fork height"
part = "lift"
low = 0.05
high = 1.2
speed = 0.25
rest = 0.1
slides = true
"""
WORDS = """
[[action]]
phrase = "raise lift to {height}"
id = "RaiseLift"
call = "lifting:raise_lift"
needs = ["lift"]
slots = { height = "length" }
"""
FUNCTION = '''
from btlang.actions.joints import bring


def raise_lift(robot, height):
    """Brings the fork to a height in metres."""
    yield from bring(robot, {"fork height": height})
'''
MISSION = ["run", "-c", "raise the lift to 20 cm", "--keywords", "lift.toml"]


@pytest.fixture(autouse=True)
def files(domain: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.chdir(tmp_path)
    for name, text in (("forklift.toml", ROBOT), ("lift.toml", WORDS), ("lifting.py", FUNCTION)):
        (tmp_path / name).write_text(text, encoding="utf-8")


def test_simulated(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*MISSION, "--robot", "forklift.toml", "--speed", "max"]) == 0
    assert "0.40  done   raise lift to 0.2 m" in capsys.readouterr().out  # 10 cm at 25 cm/s
    assert main([*MISSION, "--speed", "max"]) == 2
    assert "has no lift" in capsys.readouterr().err


def test_over_ros(start_sim, client: Client, tmp_path: Path) -> None:
    states = client.hear(JointState, "/joint_states")
    start_sim("--robot", str(tmp_path / "forklift.toml"))
    assert states.wait().position[0] == pytest.approx(0.1)  # metres
    assert not client.node.count_publishers("/sightings")  # it recognises nothing, so nobody waits for what it sees
    assert main([*MISSION, "--robot", "forklift.toml", "--over", "ros", "--sim-time"]) == 0
    states.wait(lambda state: abs(state.position[0] - 0.2) < 0.011)

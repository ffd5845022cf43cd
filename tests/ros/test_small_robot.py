"""Another body over ROS 2: other joints, other limits, one hand and no dock."""

from __future__ import annotations

from pathlib import Path

import pytest
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState, LaserScan

from btlang.cli import main
from btlang.vocabulary.shipped import BODIES
from tests.ros.client import Client

SMALL = ["--robot", "small", "--over", "ros", "--sim-time"]
PARROT = """
from btlang.speech.engine import SpeechError

class Parrot:
    def __init__(self, settings):
        if settings.language != "en":
            raise SpeechError("it speaks English only")
"""


@pytest.fixture(autouse=True)
def _in_domain(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))


def test_the_simulated_robot_is_that_of_the_file(start_sim, client: Client) -> None:
    states, scans = client.hear(JointState, "/joint_states"), client.hear(LaserScan, "/scan", qos_profile_sensor_data)
    start_sim("--robot", "small")
    assert list(states.wait().name) == ["shoulder", "elbow", "neck"]
    scan = scans.wait()
    assert (scan.header.frame_id, scan.range_max) == ("laser", 5.0)
    services = {name for name, _ in client.node.get_service_names_and_types()}
    assert "/right_hand/close" in services
    assert not services & {"/left_hand/close", "/dock"}


def test_a_mission_runs_on_it(start_sim, capfd: pytest.CaptureFixture[str]) -> None:
    start_sim("--robot", "small", "--speed", "2")  # at 5 a pause of 200 ms on a busy machine is a second of standing
    assert main(["run", "-c", "look left then raise the arm then move forward 30 cm", *SMALL]) == 0
    assert "The mission succeeded" in capfd.readouterr().out


def test_a_scanner_is_where_the_robot_file_has_it(
    start_sim, tmp_path: Path, capfd: pytest.CaptureFixture[str], client: Client
) -> None:
    """Turned to the left and off the centre, with a wall ahead: its first beam points away from that."""
    small = Path(BODIES, "small.toml").read_text(encoding="utf-8")
    frame = 'frame = "laser"\n'
    mounted, elsewhere = tmp_path / "mounted.toml", tmp_path / "elsewhere.toml"
    mounted.write_text(
        small.replace(frame, 'frame = "cart/laser"\nahead = 0.1\nleft = -0.05\nangle = 90\n'), encoding="utf-8"
    )
    elsewhere.write_text(small.replace(frame, 'frame = "lidar"\n'), encoding="utf-8")
    world = tmp_path / "wall.toml"
    world.write_text("start = { x = 1, y = 1 }\nwalls = [[[1.5, 0], [1.5, 2]]]\n", encoding="utf-8")
    scans = client.hear(LaserScan, "/scan", qos_profile_sensor_data)
    start_sim("--robot", str(mounted), "--world", str(world), "--speed", "5")
    ranges = scans.wait().ranges
    assert ranges[0] > 4.9
    assert ranges[270] == pytest.approx(0.4, abs=0.01)
    ahead = "check that the distance ahead is above 33 cm, then check that the distance ahead is below 37 cm"
    run = ["run", "--over", "ros", "--sim-time", "-c", ahead]
    assert main([*run, "--robot", str(mounted)]) == 0
    output = capfd.readouterr()
    assert "laser" not in output.out + output.err
    assert main([*run, "--robot", str(elsewhere)]) == 1
    assert "the laser scan is in the frame 'laser', but the robot file has 'lidar'" in capfd.readouterr().out


def test_what_it_lacks_is_said(start_sim, capfd: pytest.CaptureFixture[str]) -> None:
    start_sim("--robot", "small")
    assert main(["run", "-c", "nod then raise the left arm", *SMALL]) == 2
    assert "BT072: The robot 'small' has no left arm, which 'raise the left arm' needs." in capfd.readouterr().err
    assert main(["run", "-c", "look left then nod", *SMALL, "--preflight"]) == 1
    out = capfd.readouterr().out
    assert 'part    posture "nod"' in out
    assert "Missing: 1 of " in out


def test_a_language_that_it_lacks_is_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "parrot.py").write_text(PARROT, encoding="utf-8")
    (tmp_path / "robot.toml").write_text(
        'name = "talker"\nradius = 0.2\n[voice]\nengine = "parrot:Parrot"\n', encoding="utf-8"
    )
    robot = str(tmp_path / "robot.toml")
    assert main(["run", "-c", "speak English then speak Finnish", "--robot", robot, "--over", "ros"]) == 2
    err = capfd.readouterr().err
    assert "BT072: The robot 'talker' has no voice for the language \"fi\", which 'speak Finnish' needs." in err

"""Devices that are topics, and devices shown as topics: a robot runs on the shown devices of another one."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image, Range
from std_msgs.msg import Int16MultiArray, String

import btlang
from btlang.cli import main
from btlang.devices.device_set import DeviceSet
from btlang.devices.driver import DeviceError
from btlang.robots.bodies.body_file import load_body
from btlang.robots.registry import connector
from tests.components.robots import robot_file
from tests.ros.client import Client
from tests.ros.processes import Command, wait_until

ROOM = """
walls = [[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]]
start = { x = 1, y = 2, facing = 0 }
[[places]]
name = "lab"
x = 2.0
y = 2.4
"""
SHOWN = """
[[device]]
name = "eye"
kind = "camera"
driver = "simulated"
[[device]]
name = "ear"
kind = "microphone"
driver = "simulated"
[[device]]
name = "front"
kind = "range"
driver = "simulated"
"""


def device(name: str, kind: str, options: str = "") -> str:
    return f'[[device]]\nname = "{name}"\nkind = "{kind}"\ndriver = "topic"\noptions = {{ silence = 3.0{options} }}\n'


@pytest.fixture
def shown(tmp_path: Path, domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Command]:
    """The simulated devices of the standard robot and three more, as topics."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    folder = tmp_path / "shown"
    folder.mkdir()
    (tmp_path / "room.toml").write_text(ROOM, encoding="utf-8")
    robot = robot_file(folder, SHOWN)
    command = Command(
        folder, domain, "ros-devices", "--robot", robot, "--simulate", "--world", str(tmp_path / "room.toml")
    )
    command.wait_for("ready with")
    yield command
    assert command.end() == 130
    assert "Traceback" not in command.err


def test_a_robot_goes_to_the_lab_on_devices_that_are_topics(tmp_path: Path, shown: Command) -> None:
    mine = device("drive", "drive", ", wheel_gap = 0.3") + device("lidar", "lidar") + device("battery", "battery")
    robot = connector(robot_file(tmp_path, mine + device("front", "range") + device("display", "display")), "devices")
    mission = btlang.parse_tree(
        "if the battery is above 20%, go to the lab\nprint there", world=str(tmp_path / "room.toml")
    )
    with btlang.Session(robot, world=mission.world) as session:
        devices: DeviceSet = session.connection.devices  # type: ignore[attr-defined]
        wait_until(lambda: not any(why for _, why in devices.states()), "all devices tell something")
        outcome = session.run(mission, time_limit=60.0).outcome
        assert outcome is not None
        assert outcome.succeeded, outcome.why()
        assert session.robot.pose.distance_to((2.0, 2.4)) < 0.2
        shown.end()
        wait_until(lambda: "nothing arrives on /drive" in str(dict(_by_name(devices))["drive"]), "silence")
        assert not session.run(mission).outcome.succeeded  # type: ignore[union-attr]


def _by_name(devices: DeviceSet) -> list[tuple[str, str | None]]:
    return [(each.name, why) for each, why in devices.states()]


def test_pictures_sound_and_commands(shown: Command, client: Client) -> None:
    pictures = client.hear(Image, "/eye", qos_profile_sensor_data)
    sounds = client.hear(Int16MultiArray, "/ear", qos_profile_sensor_data)
    ranges = client.hear(Range, "/front", qos_profile_sensor_data)
    before = ranges.wait(since=0).range
    picture, sound = pictures.wait(since=0), sounds.wait(since=0)
    assert (picture.encoding, len(picture.data)) == ("rgb8", 3 * picture.width * picture.height)
    assert [(each.label, each.size) for each in sound.layout.dim][1] == ("rate", 16_000)
    drive, twist = client.publisher(Twist, "/drive/command"), Twist()
    twist.linear.x = float("nan")
    drive.publish(twist)  # refused
    twist.linear.x = 0.3
    moved = len(ranges.messages)
    until = time.monotonic() + 20
    while ranges.messages[-1].range > before - 0.2 and time.monotonic() < until:
        drive.publish(twist)
        time.sleep(0.05)
    assert ranges.wait(lambda told: told.range < before - 0.2, moved)
    assert "a command for the drive was refused: a velocity that is not finite" in shown.err
    client.publisher(String, "/display").publish(String(data="hello"))


def test_topics_that_say_nothing(tmp_path: Path, domain: int, client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    devices = DeviceSet(load_body(robot_file(tmp_path, device("front", "range"))), None, lambda kind, data: None)
    devices.start()
    eye = devices.readers["front"]
    try:
        wait_until(lambda: "nothing arrives on /front" in str(eye.silent("front")), "the reason")
        publisher = client.publisher(Range, "/front")
        wait_until(lambda: publisher.publish(Range(range=1.5)) or not eye.silent("front"), "a value")
        assert eye.read("front").distance == pytest.approx(1.5)  # type: ignore[attr-defined]

        def is_refused() -> bool:
            publisher.publish(Range(range=float("nan")))
            return "its range is not a number" in str(eye.silent("front"))

        wait_until(is_refused, "the reason")
        with pytest.raises(DeviceError):
            eye.read("front")
    finally:
        devices.close()


def test_a_device_that_falls_silent_is_reported(tmp_path: Path, domain: int) -> None:
    robot = robot_file(tmp_path, '[[device]]\nname = "eye"\nkind = "camera"\ndriver = "camera"\nport = "/dev/none"\n')
    command = Command(tmp_path, domain, "ros-devices", "--robot", robot)
    command.wait_for("the eye is silent: ")
    assert command.end() == 130


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ([], "the following arguments are required: --robot"),
        (["--robot", "ros"], "expected small, standard or a robot file, not 'ros'"),
        (["--robot", "standard"], "the robot file has no [[device]]; --simulate shows simulated ones"),
    ],
)
def test_options_of_ros_devices(options: list[str], reason: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["ros-devices", *options])
    assert reason in capsys.readouterr().err

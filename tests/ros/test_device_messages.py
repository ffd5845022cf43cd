"""Readings and commands as messages and back: what is shown is what is read, and what can't be true is silence."""

from __future__ import annotations

from math import degrees, inf, nan
from types import SimpleNamespace
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Image, Imu, JointState, LaserScan, Range
from std_msgs.msg import Int16MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from btlang.devices import kinds
from btlang.devices.driver import Device, DeviceError, DeviceSilent, driver_class
from btlang.devices.kinds import KINDS
from btlang.ros.devices.nodes import TRANSLATIONS, TopicClient
from btlang.ros.devices.setting import Setting, TopicDevice, topic_name
from btlang.ros.messages import stamp
from btlang.ros.subscriptions import MessageGate

SETTING = Setting("elbow", wheel_gap=0.3, range=4.0)
READINGS = {
    "range": kinds.Distance(1.5),
    "lidar": kinds.Scan([1.0, inf, 3.0], 10.0, 2.0),
    "imu": kinds.Motion(30.0, 0.5, -0.25, 9.75, 90.0),
    "battery": kinds.Charge(50.0, 12.5, -1.5, None, False),
    "joint": kinds.JointState(45.0, 10.0),
    "hand": kinds.Grip(0.5, True),
    "camera": kinds.Image(2, 1, bytes(range(6))),
    "microphone": kinds.Sound(b"\1\0\2\0\xff\xff", 16_000),
    "speaker": kinds.Playing(1.25),
    "button": kinds.Pressed(True),
}
IMU, TURNED = Imu(), Odometry()
TURNED.pose.pose.orientation.w = 2.0
IMU.angular_velocity.z = nan
COMMANDS = {
    "drive": kinds.WheelSpeeds(0.2, 0.4),
    "joint": kinds.JointTarget(45.0, 9.0),
    "hand": kinds.GripTarget(0.75),
    "speaker": kinds.Play(b"\1\0\2\0", 8_000),
    "light": kinds.Colour(1.0, 0.5, 0.0),
    "display": kinds.Shown("hello"),
}


def values(record: Any) -> list[object]:
    """As far as messages keep them."""
    listed = [list(value) if isinstance(value, list) else [value] for value in record.as_dict().values()]
    return [pytest.approx(each, abs=1e-5) if isinstance(each, float) else each for values in listed for each in values]


@pytest.mark.parametrize("kind", READINGS)
def test_readings_there_and_back(kind: str) -> None:
    translation, reading = TRANSLATIONS[kind](SETTING), READINGS[kind]
    assert values(reading) == values(TRANSLATIONS[kind](SETTING).reading(translation.shown(reading)))


@pytest.mark.parametrize("kind", COMMANDS)
def test_commands_there_and_back(kind: str) -> None:
    command = COMMANDS[kind]
    assert values(command) == values(TRANSLATIONS[kind](SETTING).command(TRANSLATIONS[kind](SETTING).sent(command)))


@pytest.mark.parametrize("kind", [kind for kind in KINDS.values() if kind.moves], ids=lambda kind: kind.name)
def test_what_brings_to_rest_does_so_there(kind: Any) -> None:
    there = TRANSLATIONS[kind.name](SETTING)
    assert there.command(there.sent(kind.command())) == kind.command()


def test_the_wheels_of_a_base_roll_as_its_odometry_says() -> None:
    here, there = TRANSLATIONS["drive"](SETTING), TRANSLATIONS["drive"](SETTING)
    for way in range(8):  # a curve to the left
        told = there.shown(kinds.Wheels(0.1 * way, 0.12 * way, 0.2, 0.24))
        found = here.reading(told)
    assert values(found) == values(kinds.Wheels(0.7, 0.84, 0.2, 0.24))
    told.pose.pose.position.x += 50.0
    with pytest.raises(DeviceSilent, match="jumps by"):
        here.reading(told)
    assert values(here.reading(told)) == values(kinds.Wheels(0.7, 0.84, 0.2, 0.24))


@pytest.mark.parametrize(
    ("kind", "message", "reason"),
    [
        ("range", Range(range=nan), "not a number"),
        ("lidar", LaserScan(angle_increment=0.1, range_max=5.0, ranges=[nan, nan]), "no valid beam"),
        ("imu", IMU, "not a number"),
        ("battery", BatteryState(percentage=nan), "no percentage"),
        ("battery", BatteryState(percentage=55.0), "no percentage"),
        ("joint", JointState(name=["wrist"], position=[1.0]), "doesn't report the joint"),
        ("joint", JointState(name=["elbow"]), "no position"),
        ("joint", JointState(name=["elbow"], position=[nan]), "not a number"),
        ("drive", TURNED, "invalid quaternion"),
        ("camera", Image(width=2, height=2, encoding="rgb8", data=[1]), "has 1 bytes"),
        ("camera", Image(width=2, height=2, encoding="bayer"), "in bayer"),
        ("microphone", Int16MultiArray(data=[1]), "no dimension"),
    ],
)  # fmt: skip
def test_what_cannot_be_true_is_silence(kind: str, message: Any, reason: str) -> None:
    with pytest.raises(DeviceSilent, match=reason):
        TRANSLATIONS[kind](SETTING).reading(message)


def test_commands_that_are_none() -> None:
    twist = Twist()
    twist.linear.x = inf
    with pytest.raises(DeviceError):
        TRANSLATIONS["drive"](SETTING).command(twist)
    with pytest.raises(DeviceError):
        TRANSLATIONS["joint"](SETTING).command(JointTrajectory(joint_names=["wrist"]))
    points = [JointTrajectoryPoint(positions=[nan])]
    with pytest.raises(DeviceError):
        TRANSLATIONS["joint"](SETTING).command(JointTrajectory(joint_names=["elbow"], points=points))


def test_stamps_that_stand_still_go_back_or_fall_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [500.0]
    monkeypatch.setattr("btlang.ros.subscriptions.time.monotonic", lambda: now[0])
    gate, message = MessageGate(Range, all_stamps=True), Range()
    assert gate.refuses(message) == ""  # without a stamp nothing is known
    faults = []
    for at, stamped in ((500.0, 90.0), (500.1, 90.1), (500.2, 90.1), (503.0, 90.5), (503.1, 20.0), (503.2, 20.1)):
        now[0], message.header.stamp = at, stamp(stamped)
        faults.append(gate.refuses(message))
    assert faults == [
        "", "", "repeats its time stamp", "is 2.5 s old", "has time stamps that go back by 70.50 s", "is 73.1 s old",
    ]  # fmt: skip
    for step in range(40):  # its clock was set: what is steady counts again
        now[0], message.header.stamp = 503.3 + 0.1 * step, stamp(20.2 + 0.1 * step)
        fault = gate.refuses(message)
    assert fault == ""


@pytest.mark.parametrize(
    ("kind", "options", "reason"),
    [
        ("drive", {}, 'needs its "wheel_gap"'),
        ("range", {"topic": "a b"}, "must be a name of ROS 2"),
        ("range", {"topics": "/a"}, 'unknown option "topics" of the eye; it has topic, command, silence'),
        ("range", {"silence": 0.0}, "must be a number from 0.2"),
    ],
)
def test_options_that_cannot_be(kind: str, options: dict[str, Any], reason: str) -> None:
    with pytest.raises(DeviceError, match=reason):
        driver_class("topic")("", [Device("eye", kind, "topic", options=options)])


def test_names_of_topics() -> None:
    assert [topic_name(name) for name in ("left arm lift", "360 view", "Größe")] == [
        "left_arm_lift", "device_360_view", "Gr__e"
    ]  # fmt: skip


def test_a_joint_in_one_of_several_messages() -> None:
    """Messages about other joints, whose stamps may be others, are none about this one."""
    told: list[Any] = []
    node: Any = SimpleNamespace(create_subscription=lambda *_: None, create_publisher=lambda *_: None)
    client = TopicClient(TopicDevice("arm", "joint", "/states", "/go", 0.5, Setting("elbow")), node)
    for seconds, name in ((3.0, "elbow"), (1.0, "wrist"), (3.1, "elbow"), (2.0, "wrist")):
        message = JointState(name=[name], position=[seconds])
        message.header.stamp = stamp(seconds)
        client.on_message(message)
        told.append(client.reading())
    assert [type(each) for each in told] == [kinds.JointState] * 4
    assert told[-1].position == pytest.approx(degrees(3.1))

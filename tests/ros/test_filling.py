"""Messages filled with slots, and values read from messages, with no node."""

from __future__ import annotations

import math
from typing import Any

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary.entry import Entry, SlotSpec
from btlang.vocabulary.ros_binding import RosBinding
from btlang.vocabulary.ros_table import read_ros

pytest.importorskip("rclpy", reason="ROS 2 is not installed")

from btlang.ros.words.fields import make_filler, make_reader
from btlang.ros.words.word import RosWord

SLOTS = ("length", "angle", "percent", "duration", "count", "text", "place")
PLACES: dict[str, Any] = {"kitchen": (4.0, -1.0, math.pi), "lobby": (1.0, 2.0, None)}


def word(table: dict[str, Any], sort: str = "action") -> RosWord:
    """A word with a slot of each type."""
    binding, problems = read_ros(table, sort)
    assert isinstance(binding, RosBinding), problems
    entry = Entry(sort, "Word", ("word",), slots=tuple(SlotSpec(slot, slot) for slot in SLOTS), ros=binding)
    return RosWord(entry, world_vocabulary(), PLACES.__getitem__)


def filled(interface: str, message: dict[str, Any], **values: Any) -> Any:
    """A message of a type."""
    made = word({"publish": interface, "name": "/x", "message": message})
    return make_filler(made, made.interface(), made.ros.get("message"), lambda: None)(values)


def test_units() -> None:
    fields = {"linear": {"x": "{length}", "y": "{length:cm}", "z": 2}, "angular.z": "{angle}", "angular.x": "{percent}"}
    twist = filled("geometry_msgs/msg/Twist", fields, length=1.5, angle=90.0, percent=20.0)
    assert (twist.linear.x, twist.linear.y, twist.linear.z) == (1.5, 150.0, 2.0)
    assert (twist.angular.z, twist.angular.x) == pytest.approx((math.pi / 2, 0.2))


def test_what_is_left_out_stays() -> None:
    twist = filled("geometry_msgs/msg/Twist", {"linear": {"x": "{length}", "y": 1.0}})
    assert (twist.linear.x, twist.linear.y) == (0.0, 1.0)


def test_places() -> None:
    pose = filled("geometry_msgs/msg/PoseStamped", {"pose": "{place}"}, place="kitchen")
    assert pose.header.frame_id == ""
    assert (pose.pose.position.x, pose.pose.position.y) == (4.0, -1.0)
    assert (pose.pose.orientation.z, pose.pose.orientation.w) == pytest.approx((1.0, 0.0))
    path = filled("nav_msgs/msg/Path", {"poses": [{"pose.position": "{place}"}]}, place="lobby")
    assert (path.poses[0].pose.position.x, path.poses[0].pose.position.y) == (1.0, 2.0)
    path = filled("nav_msgs/msg/Path", {"poses": ["{place}"]}, place="lobby")
    assert path.poses[0].header.frame_id == "map"


def test_a_place_that_nobody_knows() -> None:
    with pytest.raises(ActionFailed, match="I don't know where Oz is"):
        filled("geometry_msgs/msg/Pose", {"position": "{place}"}, place="Oz")


def test_texts_times_constants_and_arrays() -> None:
    text = filled("std_msgs/msg/String", {"data": "{count} times {text} in {place}"}, count=2, text="hey", place="Oz")
    assert text.data == "2 times hey in Oz"
    fields = {"joint_names": ["a", "b"], "points": [{"positions": ["{angle}", 1], "time_from_start": "{duration}"}]}
    trajectory = filled("trajectory_msgs/msg/JointTrajectory", fields, angle=180.0, duration=1.25)
    [point] = trajectory.points
    assert list(point.positions) == pytest.approx([math.pi, 1.0])
    assert (point.time_from_start.sec, point.time_from_start.nanosec) == (1, 250_000_000)
    battery = filled("sensor_msgs/msg/BatteryState", {"power_supply_status": "POWER_SUPPLY_STATUS_FULL"})
    assert battery.power_supply_status == 4


def test_a_number_that_is_too_large() -> None:
    with pytest.raises(ActionFailed, match="300 does not fit data, which goes from 0 to 255"):
        filled("std_msgs/msg/UInt8", {"data": "{count}"}, count=300)


@pytest.mark.parametrize(
    ("interface", "message", "code"),
    [
        ("std_msgs/msg/Strin", {}, "BT104"),
        ("no_msgs/msg/String", {}, "BT104"),
        ("std_msgs/msg/String", {"dat": "x"}, "BT105"),
        ("geometry_msgs/msg/Twist", {"linear.q": 1}, "BT105"),
        ("geometry_msgs/msg/Twist", {"linear.x.y": 1}, "BT106"),
        ("geometry_msgs/msg/Twist", {"linear.x": "fast"}, "BT106"),
        ("geometry_msgs/msg/Twist", {"linear.x": True}, "BT106"),
        ("geometry_msgs/msg/Twist", {"linear.x": "{text}"}, "BT106"),
        ("geometry_msgs/msg/Twist", {"linear": 1}, "BT106"),
        ("geometry_msgs/msg/Twist", {"linear.x": "{length:degrees}"}, "BT106"),
        ("std_msgs/msg/Int8", {"data": 128}, "BT106"),
        ("std_msgs/msg/Int8", {"data": 1.5}, "BT106"),
        ("std_msgs/msg/String", {"data": 3}, "BT106"),
        ("std_msgs/msg/String", {"data": ["a"]}, "BT106"),
        ("sensor_msgs/msg/JointState", {"name": "elbow"}, "BT106"),
        ("geometry_msgs/msg/PoseWithCovariance", {"covariance": [1, 2]}, "BT106"),
    ],
)
def test_what_does_not_fit(interface: str, message: dict[str, Any], code: str) -> None:
    with pytest.raises(MissionError) as raised:
        filled(interface, message)
    assert [problem.code for problem in raised.value.diagnostics] == [code]


def read(message: Any, interface: str, **options: Any) -> Any:
    """The value that a table names."""
    made = word({"topic": interface, "name": "/x", **options}, "condition")
    return make_reader(made, made.interface())(message)


def test_fields_and_reductions() -> None:
    from sensor_msgs.msg import JointState, LaserScan

    joints = JointState(name=["a", "b"], position=[0.5, 1.5])
    assert read(joints, "sensor_msgs/msg/JointState", field="position[1]") == 1.5
    assert read(joints, "sensor_msgs/msg/JointState", field="position", reduce="mean") == 1.0
    with pytest.raises(ValueError, match=r"position\[2\] is not there: position has 2 elements"):
        read(joints, "sensor_msgs/msg/JointState", field="position[2]")
    scan = LaserScan(angle_min=0.0, angle_increment=math.pi / 2, range_min=0.1, ranges=[3.0, 0.05, 1.0, math.nan])
    assert read(scan, "sensor_msgs/msg/LaserScan", field="ranges", reduce="min") == 1.0
    assert read(scan, "sensor_msgs/msg/LaserScan", field="ranges", reduce="min", degrees=[-10, 10]) == 3.0
    assert read(scan, "sensor_msgs/msg/LaserScan", field="ranges", reduce="max", indexes=[1, 2]) == 1.0
    with pytest.raises(ValueError, match="ranges has no value there"):
        read(scan, "sensor_msgs/msg/LaserScan", field="ranges", reduce="min", degrees=[-100, -80])


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"field": "rangs"}, "BT105"),
        ({"field": "ranges"}, "BT106"),
        ({"field": "range_min", "reduce": "min"}, "BT106"),
        ({"field": "header"}, "BT106"),
        ({"field": "range_min[0]"}, "BT106"),
        ({"field": "range_min.x"}, "BT106"),
    ],
)
def test_what_cannot_be_read(options: dict[str, Any], code: str) -> None:
    with pytest.raises(MissionError) as raised:
        read(None, "sensor_msgs/msg/LaserScan", **options)
    assert [problem.code for problem in raised.value.diagnostics] == [code]

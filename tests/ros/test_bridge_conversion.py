"""Messages as JSON and back, for every type that is installed."""

from __future__ import annotations

import json
import math
import random
from importlib import import_module
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="ROS 2 is not installed")

from builtin_interfaces.msg import Time
from std_msgs.msg import Empty, Float64MultiArray, Header, Int64, String, UInt8MultiArray
from std_srvs.srv import Trigger

from btlang.ros.bridge.conversion import as_data, fill_message
from btlang.ros.bridge.replies import BridgeError
from btlang.ros.words.fields import INTEGERS, array_of, field_types

PACKAGES = (
    "action_msgs", "diagnostic_msgs", "geometry_msgs", "nav_msgs", "rcl_interfaces", "sensor_msgs", "shape_msgs",
    "std_msgs", "trajectory_msgs", "unique_identifier_msgs", "visualization_msgs",
)  # fmt: skip
CLASSES = [
    cls
    for package in PACKAGES
    for cls in vars(import_module(f"{package}.msg")).values()
    if hasattr(cls, "get_fields_and_field_types")
]


def noon() -> Time:
    return Time(sec=12)


def anything(kind: str, draw: random.Random) -> Any:
    """JSON for a field of a type."""
    array = array_of(kind)
    if array is not None:
        return [anything(array[0], draw) for _ in range(2 if array[1] is None else array[1])]
    if "/" in kind:
        package, _, name = kind.partition("/")
        cls = getattr(import_module(f"{package}.msg"), name)
        return {field: anything(type, draw) for field, type in field_types(cls).items()}
    if kind == "boolean":
        return draw.choice([True, False])
    if kind.startswith(("string", "wstring")):
        return draw.choice(["", "a", "é\n🤖"])
    if kind in ("float", "double"):
        return draw.choice([0.0, -1.5, 0.25])
    return draw.choice(INTEGERS["uint8" if kind == "octet" else kind])


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)
def test_there_and_back(cls: Any) -> None:
    draw = random.Random(1)
    for _ in range(3):
        data = {field: anything(kind, draw) for field, kind in field_types(cls).items()}
        message = fill_message(cls, data, noon)
        written = json.loads(json.dumps(as_data(message), allow_nan=False))
        assert fill_message(cls, written, noon) == message


def test_what_json_has_no_word_for() -> None:
    data = [1.0, math.nan, -math.inf]
    assert as_data(Float64MultiArray(data=data))["data"] == [1.0, None, None]
    assert as_data(UInt8MultiArray(data=[0, 255]))["data"] == "AP8="
    assert as_data(Empty()) == as_data(Trigger.Request()) == {}


def test_a_header_gets_the_time() -> None:
    assert fill_message(Header, {}, noon).stamp.sec == 0
    pose = import_module("geometry_msgs.msg").PoseStamped
    assert fill_message(pose, {}, noon).header.stamp.sec == 12
    assert fill_message(pose, {"header": {"frame_id": "map"}}, noon).header.stamp.sec == 12
    assert fill_message(pose, {"header": {"stamp": {"sec": 3}}}, noon).header.stamp.sec == 3


@pytest.mark.parametrize(
    ("cls", "data", "reason"),
    [
        (String, {"data": "\ud800"}, "data is string"),
        (String, {"date": "x"}, "has no field 'date'. Its fields: data."),
        (String, {"da\nta": "x"}, r"has no field 'da\nta'"),
        (String, ["a", "b"], "must be an object"),
        (Int64, {"data": 2**63}, "data is int64"),
        (Int64, {"data": 1.0}, "data is int64"),
        (UInt8MultiArray, {"data": "AP8"}, "data isn't base64"),
        (UInt8MultiArray, {"data": [1, 256]}, "data[1] is uint8"),
        (UInt8MultiArray, {"layout": {"dim": [{"size": -1}]}}, "layout.dim[0].size is uint32"),
    ],
)
def test_what_does_not_fit(cls: Any, data: Any, reason: str) -> None:
    with pytest.raises(BridgeError) as refused:
        fill_message(cls, data, noon)
    assert reason in str(refused.value)

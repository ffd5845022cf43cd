"""The `ros` tables of keyword files, as far as they are read without ROS 2."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.text.source import Source
from btlang.vocabulary.keyword_file import read_keyword_file
from btlang.vocabulary.ros_binding import Fields, RosBinding
from btlang.vocabulary.ros_table import KINDS, read_ros

DOCS = Path(__file__).parent.parent.parent / "docs"
PAGE = "".join((DOCS / name).read_text(encoding="utf-8") for name in ("ros_words.md", "ros.md"))


def wrong(table: Any, sort: str = "action") -> str:
    """The one thing that is wrong with a table."""
    binding, problems = read_ros(table, sort)
    assert binding is None
    [(reason, _)] = problems
    return reason


def test_a_table() -> None:
    table = {
        "action": "nav2_msgs/action/NavigateToPose",
        "name": "/go",
        "goal": {"pose": {"header": {"frame_id": "map"}}, "pose.pose": "{place}", "tags": ["a", {"x": 1}]},
        "wait": 2,
    }
    binding, problems = read_ros(table, "action")
    assert problems == []
    goal = Fields((("pose.header.frame_id", "map"), ("pose.pose", "{place}"), ("tags", ("a", Fields((("x", 1),))))))
    assert binding == RosBinding("action", "nav2_msgs/action/NavigateToPose", "/go", (("goal", goal), ("wait", 2)))


STRING = {"publish": "std_msgs/msg/String", "name": "/speech"}
TOPIC = {"topic": "std_msgs/msg/Bool", "name": "/docked"}


@pytest.mark.parametrize(
    ("table", "sort", "reason"),
    [
        ("/speech", "action", "it must be a table such as"),
        ({"name": "/speech"}, "action", ", and none is given"),
        ({"pubish": "std_msgs/msg/String"}, "action", "none is given; similar: publish"),
        ({**STRING, "topic": "x"}, "action", "both publish and topic are given"),
        ({**STRING, "publish": "std_msgs/String"}, "action", "publish must be a type such as"),
        ({**STRING, "publish": "std_srvs/srv/Trigger"}, "action", "publish must be a type"),
        ({**STRING, "name": "my speech"}, "action", 'name = "..." must be the name of the topic'),
        ({"publish": "std_msgs/msg/String"}, "action", 'name = "..." must be the name of the topic'),
        ({**STRING, "mesage": {}}, "action", "'mesage' is not a key for publish; the keys are finally, for,"),
        ({**STRING, "message": "hello"}, "action", "message must be a table of fields"),
        ({**STRING, "rate": 0}, "action", "rate must be a number above 0"),
        ({**STRING, "for": "long"}, "action", "for must be a number or a slot"),
        ({**STRING, "latched": 1}, "action", "latched must be true or false"),
        ({**STRING, "finally": {}}, "action", "finally needs for"),
        (STRING, "condition", "publish is for actions, not for conditions"),
        (TOPIC, "action", "topic is for conditions and quantities, not for actions"),
        ({**TOPIC, "below": 3}, "condition", 'topic needs field = "..."'),
        (TOPIC, "quantity", 'topic needs field = "...", the field to measure'),
        ({**TOPIC, "field": "x", "below": 3}, "quantity", "'below' is not a key for topic"),
        ({**TOPIC, "field": "x", "reduce": "middle"}, "condition", "reduce must be one of min, max"),
        ({**TOPIC, "field": "x", "degrees": [1]}, "condition", "degrees must be two numbers"),
        ({**TOPIC, "field": "x", "degrees": [1, 2], "indexes": [1, 2]}, "condition", "indexes and degrees"),
        ({"drive": "geometry_msgs/msg/Twist", "name": "/v"}, "action", "drive needs one of forward, backward"),
        ({"joints": "trajectory_msgs/msg/JointTrajectory", "name": "/j"}, "action", "joints needs positions"),
        ({"parameter": "p", "name": "/n"}, "action", "parameter needs set"),
        ({"parameter": "p", "name": "/n"}, "condition", "parameter needs one of below"),
        ({"parameter": 3, "name": "/n", "set": 1}, "action", "parameter must be the name of a parameter"),
        ({"phrase": "", "name": "/n"}, "action", "phrase must be a phrase or the id of a served action"),
        ({"phrase": "say {text}"}, "action", 'name = "..." must be the name of the action, such as "/robot/arm"'),
        ({"phrase": "battery", "name": "/n"}, "condition", "phrase is for actions, not for conditions"),
    ],
)
def test_what_is_wrong(table: Any, sort: str, reason: str) -> None:
    assert reason in wrong(table, sort)


def test_all_is_told_at_once_and_at_its_place() -> None:
    text = '[[action]]\nphrase = "hum"\nid = "Hum"\nros = { publish = "x", name = "/hum", loud = true }\n'
    with pytest.raises(MissionError) as raised:
        read_keyword_file(Source(text))
    assert [(d.code, d.span.text) for d in raised.value.diagnostics] == [("BT102", "x"), ("BT102", "loud")]


def test_every_key_is_documented() -> None:
    keys = {key for sorts in KINDS.values() for keys in sorts.values() for key in keys} | set(KINDS)
    assert [key for key in sorted(keys) if f"`{key}`" not in PAGE] == []


def test_examples_of_the_page() -> None:
    """They can be read, and each kind has one."""
    examples = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    entries = [entry for text in examples for entry in read_keyword_file(Source(text)).entries]
    assert {entry.ros.kind for entry in entries if entry.ros is not None} >= set(KINDS) - {"service"}

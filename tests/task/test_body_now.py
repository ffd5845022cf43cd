"""What watchers see of a body: its joints, the word that it says, and its URDF; of a robot without links nothing."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from math import radians
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from btlang.robots.bodies.body_file import read_body
from btlang.robots.robot import RobotError
from btlang.task.live.robot_now import BodyNow
from tests.robots.motion.bodies import GUIDE

from .layers import ask, layer_in, refusal, submit
from .test_feed import Watcher

BODY = read_body(str(GUIDE))


def a_robot(**fields: Any) -> Any:
    return SimpleNamespace(body=BODY, said=None, said_at=0.0, time=0.0, joint=lambda name: 0.0, **fields)


def test_joints_are_in_radians_in_the_order_of_the_urdf_ten_times_a_second() -> None:
    angles = {joint.name: float(index) for index, joint in enumerate(BODY.joints)}
    robot, body = a_robot(), BodyNow()
    robot.joint = angles.__getitem__
    body.look(robot, 10.0)
    assert body.joints == [round(radians(index), 3) for index in range(len(BODY.joints))]
    angles["waist turn"] = 40.0
    body.look(robot, 10.05)
    assert body.joints[0] == 0.0
    body.look(robot, 10.1)
    assert body.joints[0] == round(radians(40.0), 3)


def test_a_joint_that_says_nothing_is_unknown() -> None:
    robot, body = a_robot(), BodyNow()

    def silent(name: str) -> float:
        if name == "head turn":
            raise RobotError("no joint states")
        return 0.0

    robot.joint = silent
    body.look(robot, 0.0)
    assert [joint.name for joint, angle in zip(BODY.joints, body.joints, strict=True) if angle is None] == ["head turn"]


def test_a_body_without_links_has_nothing_to_show(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        watcher.wait(lambda message: message["type"] == "scan")
        assert watcher.of("joints") == []
        assert "no links" in refusal(layer, "urdf")


def test_a_gesture_and_words_are_seen(tmp_path: Path) -> None:
    with layer_in(tmp_path, robot=str(GUIDE), speed=4.0) as layer:
        joints = ET.fromstring(ask(layer, "urdf")["urdf"]).findall("joint")
        watcher = Watcher(layer)
        submit(layer, 'wave then say "Welcome to the museum."')
        elbow = [joint.get("name") for joint in joints].index("right_elbow")
        watcher.wait(lambda message: message["type"] == "joints" and message["positions"][elbow] > 0.5)
        watcher.wait(lambda message: message.get("event", {}).get("event") == "end" and message["task"] == 1)
        watcher.wait(lambda message: message["type"] == "speech" and not message["text"])
        spoken = [each for each in watcher.of("speech") if each["text"]]
        words = [each["text"][each["start"] : each["end"]] for each in spoken]
        assert words == [word for word in ["Welcome", "to", "the", "museum."] if word in words]
        assert words

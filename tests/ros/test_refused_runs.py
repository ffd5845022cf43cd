"""What a robot that was stopped must not leave behind."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("nav2_msgs", reason="nav2_msgs is not installed")

from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world_file import load_world
from btlang.ros.node import SpunNode
from btlang.ros.robot.robot import RosRobot


def test_a_robot_that_was_stopped_sends_no_goal(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cancelling one that was sent is not enough: a navigation server may reject the cancel."""
    monkeypatch.setattr(RosRobot, "pose", Pose(0.0, 0.0))
    sent: list[str] = []

    def start(name: str, goal: Pose) -> Any:
        sent.append(name)
        return SimpleNamespace(end=lambda reason: None)

    with SpunNode("stopped", domain_id=domain) as spun:
        robot = RosRobot(spun.node, load_world())
        robot.prepare_navigation()
        monkeypatch.setattr(robot._navigation, "start", start)
        robot.navigate_to("kitchen")
        robot.disable()
        with pytest.raises(RobotError, match="the robot was stopped"):
            robot.navigate_to("kitchen")
    assert sent == ["kitchen"]

"""A command that never returns: the node says so, the robot stands still, and nobody waits for it twice."""

from __future__ import annotations

import importlib
import time
from functools import partial
from pathlib import Path
from typing import Any

import pytest

WORDS = """
[[action]]
phrase = "hang"
id = "Hang"
call = "a_command_that_hangs:hang"
"""
COMMAND = """
from threading import Event

entered, released = Event(), Event()


def hang(robot):
    robot.drive(0.5, 0.0)
    entered.set()
    released.wait()
"""


def test_a_command_that_hangs(tmp_path: Path, domain: int, run_mission: Any, monkeypatch: pytest.MonkeyPatch):
    from rclpy.lifecycle import TransitionCallbackReturn

    from btlang.ros.mission.node import MissionNode
    from btlang.ros.mission.setup import Setup
    from btlang.ros.node import SpunNode
    from btlang.task.execution import executor
    from tests.ros.processes import LONG, wait_until

    (tmp_path / "words.toml").write_text(WORDS, encoding="utf-8")
    (tmp_path / "a_command_that_hangs.py").write_text(COMMAND, encoding="utf-8")
    (tmp_path / "mission.txt").write_text("hang", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(executor, "_END", 0.5)
    command = importlib.import_module("a_command_that_hangs")
    lines: list[str] = []
    layer = {"folder": str(tmp_path / "robot")}
    setup = Setup(file=str(tmp_path / "mission.txt"), keywords=[str(tmp_path / "words.toml")], layer=layer)
    with SpunNode("btlang", domain_id=domain, make=partial(MissionNode, setup, lines.append, lambda: None)) as spun:
        node: Any = spun.node
        node.trigger_configure()
        node.trigger_activate()
        assert command.entered.wait(LONG)
        assert node.trigger_deactivate() == TransitionCallbackReturn.FAILURE
        monkeypatch.setattr(executor, "_END", LONG)
        began = time.monotonic()
        assert not node.halt()
        assert time.monotonic() - began < LONG / 2
        command.released.set()
        wait_until(node.halt, "the end of the mission")
        assert node.trigger_deactivate() == TransitionCallbackReturn.SUCCESS
        wait_until(lambda: any(line.endswith(": the node was deactivated") for line in lines), "the line of the task")
        node.release()

"""--robot and --over on the command line."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.repl.draft import MissionDraft

OVER_ROS = 'name = "far"\nradius = 0.2\nover = "ros"\nscreen = true\n'


@pytest.fixture
def far(tmp_path: Path) -> str:
    """A robot that runs over ROS 2."""
    path = tmp_path / "far.toml"
    path.write_text(OVER_ROS)
    return str(path)


def test_a_robot_file_runs(far: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--speed", "max", "--robot", "small", "-c", "say hello"]) == 0
    assert main(["run", "--speed", "max", "--robot", far, "--over", "simulated", "-c", "print hello"]) == 0
    assert 'prints "hello"' in capsys.readouterr().out


def test_the_prompt_takes_a_robot(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("nod\n"))
    assert main(["repl", "--speed", "max", "--robot", "small"]) == 2
    assert "The robot 'small' has no posture \"nod\"" in capsys.readouterr().err
    draft = MissionDraft(robot="small")
    draft.reset()
    assert draft.session.robot.body.name == "small"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["run", "-c", "wave", "--robot", "smal"],
            "ros, actions, small, standard or a robot file",
        ),
        (["run", "-c", "wave", "--over", "tcp"], "argument --over: invalid choice: 'tcp'"),
        (["run", "-c", "wave", "--robot", "small", "--sim-time"], "--sim-time, --namespace and --preflight are for"),
        (
            ["run", "-c", "wave", "--robot", "FAR", "--speed", "max"],
            "over ros runs in real time",
        ),
        (["repl", "--robot", "ros", "--speed", "max"], "--robot ros runs in real time, so it takes no --speed"),
        (["sim-ros", "--robot", "ros"], "simulated, small, standard or a robot file, not 'ros'"),
        (["sim-ros", "--over", "ros"], "argument --over: invalid choice: 'ros'"),
        (["serve-actions", "--robot", "actions"], "simulated, ros, small, standard or a robot file"),
        (["ros-node", "--robot", "FAR", "--over", "simulated", "--sim-time"], "--sim-time is for --robot ros"),
    ],
)
def test_usage_errors(arguments: list[str], message: str, far: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([far if word == "FAR" else word for word in arguments])
    assert message in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize("verb", [["run", "-c", "wave"], ["repl"], ["sim-ros"], ["ros-node"], ["serve-actions"]])
def test_a_wrong_robot_file_is_a_message(verb: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bad.toml"
    path.write_text('name = "bad"\nradius = "big"\n')
    assert main([*verb, "--robot", str(path)]) == 2
    assert "bad.toml:2:1: error BT071: This robot file can't be used: " in capsys.readouterr().err


def test_parts_that_are_missing_are_said_by_the_robot_too() -> None:
    robot = MissionDraft(robot="small").session.robot
    with pytest.raises(Exception, match="the robot has no dock"):
        robot.dock()
    with pytest.raises(Exception, match="the robot has no left hand"):
        robot.grasp("left")

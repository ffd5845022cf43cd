"""A mission on a ROS 2 robot from Python."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

import btlang
from btlang.engine.status import SUCCESS
from btlang.ros.connectors import connect_ros
from tests.profiles import amount
from tests.ros.processes import LONG, Command, wait_until


@pytest.fixture(autouse=True)
def _here(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))


@pytest.mark.long
def test_runs_leave_no_thread_behind(sim: Command) -> None:
    tree = btlang.parse_tree("print done")
    before = set(threading.enumerate())
    for _ in range(amount(2, 5)):
        assert tree.run(robot="ros").status == SUCCESS
    assert set(threading.enumerate()) == before


def test_an_emergency_stop_from_another_thread(sim: Command) -> None:
    mission = btlang.parse_tree("turn left 99999 degrees")
    with btlang.Session(partial(connect_ros, sim_time=True)) as session:
        run = session.start(mission)
        assert next(run.events()).run == run.id
        run.emergency_stop()
        outcome = run.wait(LONG)
    assert outcome is not None
    assert outcome.stopped == "emergency stop"
    run.emergency_stop()  # the robot is gone; nothing happens


def test_a_robot_that_lacks_something(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.ros.robot.connection._DISCOVERY", 1.0)
    monkeypatch.setattr("btlang.ros.robot.connection._AGAIN", 1.0)
    with pytest.raises(btlang.MissionError, match="BT101"):
        btlang.parse_tree("move forward").run(robot="ros")


def test_what_does_not_go_together(start_sim: Callable[..., Command], tmp_path: Path, domain: int) -> None:
    tree = btlang.parse_tree("say done")
    with pytest.raises(ValueError, match="robot must be 'simulated' or "):
        tree.run(robot="toaster")
    start_sim()
    with pytest.raises(ValueError, match="a ROS 2 robot runs in real time"):
        tree.run(robot="ros", speed="max")
    for number, options in enumerate((["--robot", "ros", "--speed", "max"], ["--sim-time"], ["--preflight"])):
        folder = tmp_path / str(number)
        folder.mkdir()
        command = Command(folder, domain, "run", "-c", "say done", *options)
        wait_until(lambda command=command: command.process.poll() is not None, "the end")  # type: ignore[misc]
        assert command.process.returncode == 2
        assert command.err.startswith("btc run: --")

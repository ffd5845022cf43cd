"""A component in one process that several robots share."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.components.words import robot_words
from tests.components.robots import machine, robot_file
from tests.components.test_faults import wait_until

SHARED = machine(shared='"the kitchen"')


@pytest.fixture(autouse=True)
def sockets(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", "")  # the folder for temporary files then
    monkeypatch.setattr("tempfile.tempdir", f"/tmp/bt-{os.getpid()}")
    os.makedirs(f"/tmp/bt-{os.getpid()}", exist_ok=True)


def status(session: btlang.Session) -> Any:
    return session.connection.manager.statuses()[0]  # type: ignore[attr-defined]


def test_two_robots_one_process(tmp_path: Path) -> None:
    robot = robot_file(tmp_path, SHARED)
    words = robot_words(robot)
    brew = btlang.parse_tree("brew tea then brew tea", keywords=words)
    asks = btlang.parse_tree("if the number of cups is above 1, print many otherwise print few", keywords=words)
    with btlang.Session(robot) as first:
        process = status(first).process
        with btlang.Session(robot) as second:
            assert status(second).process == process
            assert first.run(brew, speed="max").outcome.succeeded  # type: ignore[union-attr]
            printed: list[str] = []
            run = second.run(asks, speed="max", sinks=[lambda e: e.tag == "print" and printed.append(e.text)])
            assert run.outcome is not None
            assert (run.outcome.succeeded, printed) == (True, ["many"])  # cups of the other robot
        assert first.run(brew, speed="max").outcome.succeeded  # type: ignore[union-attr]
    wait_until(lambda: not os.path.exists(f"/proc/{process}"))


def test_its_death_is_noticed_by_all_and_they_share_the_next_one(tmp_path: Path) -> None:
    robot = robot_file(tmp_path, SHARED)
    with btlang.Session(robot) as first, btlang.Session(robot) as second:
        process = status(first).process
        for fault in (signal.SIGKILL, signal.SIGSTOP):
            os.kill(process, fault)
            wait_until(
                lambda before=process: {status(each).process for each in (first, second)} - {before, None} != set()
            )
            wait_until(lambda: all(status(each).state == "active" for each in (first, second)))
            assert status(first).process == status(second).process != process
            process = status(first).process


def test_other_parameters_are_refused(tmp_path: Path) -> None:
    robot = robot_file(tmp_path, SHARED)
    (tmp_path / "other").mkdir()
    other = robot_file(tmp_path / "other", machine(shared='"the kitchen"', parameters="{ heat = 70 }", restarts=0))
    with btlang.Session(robot), btlang.Session(other) as second:
        assert "another robot shares it with another class or other parameters" in status(second).why

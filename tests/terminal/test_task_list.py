"""`btc task list --live`, in a terminal and in a pipe."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from btlang.task.layer import TaskLayer
from tests.task.layers import ask, robot_up, submit
from tests.terminal.emulator import Terminal

BTC = (sys.executable, "-m", "btlang")
LIST = (*BTC, "task", "list", "--live")


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Iterator[TaskLayer]:
    """One that is up, and paused."""
    with tempfile.TemporaryDirectory() as short:  # the path of a socket has to be
        monkeypatch.setenv("XDG_RUNTIME_DIR", short)
        with robot_up(Path(short)) as layer:
            ask(layer, "pause")
            yield layer


def test_it_is_drawn_in_place(terminal: Callable[..., Terminal], robot: TaskLayer) -> None:
    first = submit(robot, "wait 1 h")
    seen = terminal(*LIST, width=60, height=8, environment={"XDG_RUNTIME_DIR": os.environ["XDG_RUNTIME_DIR"]})
    assert seen.wait_for("wait 1 h").splitlines() == [
        "The robot is paused.",
        "1 waiting.",
        "",
        "   1  queued     wait 1 h  [the robot is paused]",
    ]
    submit(robot, "wave")
    ask(robot, "cancel", task=first)
    screen = seen.wait_until(lambda screen: "wave" in screen and "wait 1 h" not in screen)
    assert screen.splitlines()[3:] == ["   2  queued     wave  [the robot is paused]"]
    assert not seen.cursor_shown
    seen.press("\x03")
    assert seen.wait_for_end() == 0
    assert seen.cursor_shown


def test_a_pipe_gets_what_is_new(robot: TaskLayer) -> None:
    shown = subprocess.Popen(LIST, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"})
    assert shown.stdout is not None
    with shown.stdout as lines:
        assert [next(lines) for _ in range(5)][3:] == ["There are no tasks.\n", "\n"]
        submit(robot, "wave")
        assert [next(lines) for _ in range(5)][3:] == ["   1  queued     wave  [the robot is paused]\n", "\n"]
        shown.send_signal(signal.SIGINT)
        assert shown.wait(10) == 0


def test_it_ends_when_the_robot_goes_down() -> None:
    with tempfile.TemporaryDirectory() as short:
        environment = {**os.environ, "PYTHONUNBUFFERED": "1", "XDG_RUNTIME_DIR": short, "XDG_DATA_HOME": short}
        btc = partial(subprocess.Popen, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        with btc([*BTC, "robot", "up"]) as robot:
            assert "is up" in next(robot.stdout)
            with btc(LIST) as shown:
                assert "." in next(shown.stdout)
                robot.terminate()
                printed, errors = shown.communicate(timeout=20)
            robot.communicate()
    assert printed.endswith("The robot 'robot' is down.\n")
    assert (shown.returncode, errors) == (0, "")

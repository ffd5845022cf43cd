"""`btc robot up --serve`: a robot and its server, which begin and end together."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress

import pytest

from tests.server.doors import child_of, free_port
from tests.task.layers import LONG


@pytest.fixture
def environment() -> Iterator[dict[str, str]]:
    with tempfile.TemporaryDirectory(prefix="bt") as folder:
        yield {**os.environ, "XDG_DATA_HOME": f"{folder}/data", "XDG_RUNTIME_DIR": folder}


def up(environment: dict[str, str], *words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "btlang", "robot", "up", *words], env=environment, text=True, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def answers(port: int) -> bool:
    with suppress(OSError), socket.create_connection(("127.0.0.1", port)):
        return True
    return False


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_robot_with_its_server(number: signal.Signals, environment: dict[str, str]) -> None:
    port = free_port()
    with up(environment, "--serve", "--port", str(port)) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline() for _ in range(4)]
        assert re.match(r"The robot 'robot' is up", lines[0])
        assert lines[1] == f"The server is up: https://127.0.0.1:{port}\n"
        assert "Log in as 'admin'" in lines[3]
        assert answers(port)
        process.send_signal(number)
        process.communicate(timeout=LONG)  # the server writes to the same standard error: it has ended too
    assert not answers(port)  # also when the robot couldn't end it


def test_a_server_that_ends_by_itself_comes_back(environment: dict[str, str]) -> None:
    port = free_port()
    with up(environment, "--serve", "--port", str(port)) as process:
        assert process.stdout is not None
        for _ in range(5):
            process.stdout.readline()
        os.kill(child_of(process.pid), signal.SIGKILL)
        assert process.stdout.readline() == "The server ended with exit code -9; it starts again.\n"
        assert process.stdout.readline().startswith("The server is up")
        assert answers(port)
        process.terminate()
    assert process.returncode == 0


def test_a_server_that_can_not_come_up_takes_the_robot_down(environment: dict[str, str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        with up(environment, "--serve", "--port", port) as process:
            out, err = process.communicate(timeout=LONG)
    assert process.returncode == 2
    assert out == "The robot 'robot' is up. Give it work with: btc task add\nThe robot 'robot' is down.\n"
    assert "BT201" in err


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--port", "9000"], "--port needs --serve"),
        (["--code", "x"], "--code needs --join"),
        (["--join", "ws://host:1"], "expected an address such as wss://host:8443"),
        (["--join", "wss://host:1/x?y"], "expected an address such as wss://host:8443"),
    ],
)
def test_what_does_not_go_together(words: list[str], reason: str, environment: dict[str, str]) -> None:
    with up(environment, *words) as process:
        _, err = process.communicate(timeout=LONG)
    assert process.returncode == 2
    assert reason in err

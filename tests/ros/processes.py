"""Commands of btlang that run in processes of their own while a test talks to them."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.forked import Process, popen

REPOSITORY = Path(__file__).parents[2]
ROOM = Path(__file__).parent / "room.toml"
LONG = 20.0
"""Seconds within which everything that a test waits for happens, on a slow machine too."""


def wait_until(condition: Callable[[], object], what: str, seconds: float = LONG) -> None:
    """Fails where something does not become true in time."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"{what}: not within {seconds} s"
        time.sleep(0.005)


STARTED: list[Process] = []


def start(*command: str, **options: Any) -> Process:
    """A process in a group of its own, which ends with the test, or with the module where that shares it.

    Robots are forked with rclpy. What runs missions is not: such a fork crashes as it ends where threads go on.
    """
    is_robot = "sim-ros" in command or any(word.startswith("tests.ros.") for word in command)
    process = popen(command, start_new_session=True, for_ros=is_robot, **options)
    STARTED.append(process)
    return process


def end_all(first: int) -> None:
    """Kills the groups of all processes that were started from that number on."""
    while len(STARTED) > first:
        process = STARTED.pop()
        if group_is_alive(process):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def group_is_alive(process: Process) -> bool:
    """Whether a process of its group is left, a zombie that nobody has waited for included."""
    process.poll()
    try:
        os.killpg(process.pid, 0)
    except ProcessLookupError:
        return False
    return True


class Command:
    """`btc` with arguments, in a process group of its own, with what it printed so far. `folder` keeps that."""

    program: tuple[str, ...] = ("-m", "btlang")

    def __init__(self, folder: Path, domain: int, *arguments: str, **environment: str | None) -> None:
        self._out, self._err = folder / "out.txt", folder / "err.txt"
        self.sockets = tempfile.mkdtemp(prefix="bt")  # their paths have to be short
        changed = {
            **os.environ, "PYTHONPATH": str(REPOSITORY), "ROS_DOMAIN_ID": str(domain),
            "XDG_DATA_HOME": str(folder), "XDG_RUNTIME_DIR": self.sockets, **environment,
        }  # fmt: skip
        with self._out.open("w") as out, self._err.open("w") as err:
            self.process = start(
                sys.executable,
                *self.program,
                *arguments,
                env={name: value for name, value in changed.items() if value is not None},
                stdout=out,
                stderr=err,
                stdin=subprocess.DEVNULL,
            )

    @property
    def out(self) -> str:
        return self._out.read_text(encoding="utf-8")

    @property
    def err(self) -> str:
        return self._err.read_text(encoding="utf-8")

    def wait_for(self, text: str) -> None:
        """Until it has printed this. Fails where it ends before."""
        wait_until(lambda: text in self.out or self.process.poll() is not None, f"'{text}' printed")
        assert text in self.out, self.err

    def end(self, number: signal.Signals = signal.SIGINT) -> int:
        """Sends a signal and waits; returns the exit code. Fails where a process is left over."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        code = self.process.wait(LONG)
        assert not group_is_alive(self.process)
        shutil.rmtree(self.sockets, ignore_errors=True)
        return code

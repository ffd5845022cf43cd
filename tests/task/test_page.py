"""The sessions that docs/tasks.md shows are real: they run in their order, with one robot."""

from __future__ import annotations

import getpass
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.task.layers import LONG
from tests.test_readme import ROOT, blocks

STATE = ("btc task list", "btc task show", "btc robot status")
"""Commands that change nothing: they are asked until they show what is expected, which may take a moment."""
_TOKEN = re.compile(r"\b[0-9a-f]{16}\b")


def steps() -> list[tuple[str, str]]:
    """The commands of the page and what each prints."""
    shown = "".join(block.text for block in blocks("session"))
    return re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", shown, re.M)


def test_sessions_are_real(tmp_path: Path) -> None:
    with tempfile.TemporaryDirectory() as short:  # the path of a socket has to be
        folders = {"XDG_RUNTIME_DIR": short, "XDG_DATA_HOME": str(tmp_path)}
        environment = {**os.environ, **folders, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
        robot, token = None, ""

        def start(line: str) -> subprocess.Popen[str]:
            [btc, *words] = shlex.split(line)
            assert btc == "btc"
            return subprocess.Popen(
                [sys.executable, "-P", "-m", "btlang", *words],
                env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            )  # fmt: skip

        try:
            for line, shown in steps():
                wanted = _TOKEN.sub("TOKEN", shown)
                if line.startswith("btc robot up"):
                    robot = start(line)
                    assert robot.stdout is not None
                    assert robot.stdout.readline() == wanted
                    continue
                until = time.monotonic() + LONG
                while True:
                    printed, _ = start(_TOKEN.sub(token, line)).communicate(timeout=60)
                    token = "".join(_TOKEN.findall(printed)) or token
                    told = _TOKEN.sub("TOKEN", printed).replace(f"by {getpass.getuser()}", "by ann")
                    if told == wanted or not line.startswith(STATE) or time.monotonic() > until:
                        break
                assert told == wanted, line
            assert robot is not None
            lines = robot.communicate(timeout=60)[0].splitlines()
            assert lines[-2].endswith(f"  Released by {getpass.getuser()}: the robot may move again.")
            assert lines[-1] == "The robot 'robot' is down."
            assert robot.returncode == 0
        finally:
            if robot is not None and robot.poll() is None:
                robot.kill()
                robot.communicate()

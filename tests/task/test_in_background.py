"""Robots in the background, as docs/tasks.md says how to keep them there."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from .layers import wait_until

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "tasks.md").read_text(encoding="utf-8").partition("## In the background")[2]


@pytest.fixture
def folder() -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as short:  # the path of a socket has to be
        yield Path(short)


def shell(command: str, folder: Path) -> str:
    """What a line prints; `btc` in it is this Python's."""
    directories = dict.fromkeys(("XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_STATE_HOME"), str(folder))
    environment = {**os.environ, **directories, "PYTHONPATH": str(ROOT)}
    command = re.sub(r"\bbtc\b", f"{sys.executable} -m btlang", command)
    ran = subprocess.run(
        ["sh", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=True
    )
    return ran.stdout


def test_a_robot_stays_up_when_its_terminal_closes(folder: Path) -> None:
    [command] = re.findall(r"^nohup btc robot up .*&$", PAGE, re.MULTILINE)
    pid, log = int(shell(f"{command} echo $!", folder)), folder / "museum.log"
    try:
        wait_until(lambda: "is up" in log.read_text(encoding="utf-8"))
        os.kill(pid, signal.SIGHUP)  # what the terminal sends as it closes
        assert "nothing to do" in shell("btc robot status --name museum", folder)
        shell("btc robot pause --name museum", folder)
        shell("btc robot resume --name museum", folder)
        assert re.search(r"  Paused by .*\n.*  The pause was ended by ", log.read_text(encoding="utf-8"))
        assert "goes down" in shell("btc robot down --name museum", folder)
        wait_until(lambda: "is down" in log.read_text(encoding="utf-8"))
    except BaseException:
        os.kill(pid, signal.SIGKILL)
        raise


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="needs systemd-analyze")
def test_systemd_takes_the_unit(folder: Path) -> None:
    [command] = re.findall(r"^(btc robot unit .*) > .*museum.service$", PAGE, re.MULTILINE)
    unit = folder / "museum.service"
    unit.write_text(shell(command, folder), encoding="utf-8")
    checked = subprocess.run(
        ["systemd-analyze", "verify", str(unit)], capture_output=True, text=True, timeout=60, check=False
    )
    assert [line for line in checked.stderr.splitlines() if "museum" in line] == []

"""The built page, and a robot with its server for a browser."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from btlang.task.missions import MissionReader
from btlang.task.task import State
from hatch_build import build_page
from tests.server.doors import PASSWORD, Program, free_port
from tests.task.layers import layer_in, submit, wait_for
from tests.web.packages import LONG, ROOT, WEB

YESTERDAY = """# Evening round
say "good evening"
go to the fountain
go to the cafe within 3 s
say "good night"
"""


@pytest.fixture(scope="session")
def page() -> Path:
    """The folder `dist`, of the sources as they are."""
    with open(Path(tempfile.gettempdir(), f"btlang-page-{os.getuid()}.lock"), "w", encoding="ascii") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        problem = build_page(WEB)
    if problem and not os.environ.get("CI"):
        pytest.skip(f"the page can't be built: {problem}")
    assert not problem
    return WEB / "dist"


def fail_yesterday(folder: Path, world: str) -> None:
    """A robot with this folder did a mission yesterday, which failed and was recorded."""
    recordings, begins = folder / "recordings", time.time() - 86_400
    with layer_in(folder, reader=MissionReader((), world), recordings=str(recordings), begins=begins) as layer:
        wait_for(layer, submit(layer, YESTERDAY), State.FAILED)
    for recording in recordings.iterdir():
        os.utime(recording, (begins, begins))


@pytest.fixture(scope="module")
def robot(page: Path) -> Iterator[str]:
    """The address of `btc robot up --serve` in the museum, with the users olga, ed and ann."""
    with tempfile.TemporaryDirectory(prefix="bt") as folder:
        environment = {**os.environ, "XDG_DATA_HOME": f"{folder}/data", "XDG_RUNTIME_DIR": folder}
        port = str(free_port())
        world = str(ROOT / "examples" / "worlds" / "museum.toml")
        fail_yesterday(Path(folder, "data", "btlang", "robots", "robot"), world)
        with closing(
            Program(environment, "robot", "up", "--serve", "--port", port, "--world", world, "--speed", "4")
        ) as up:
            up.start("The robot 'robot' is up")
            assert up.process.stdout is not None
            assert up.process.stdout.readline() == f"The server is up: https://127.0.0.1:{port}\n"
            for name, role in (("olga", "operator"), ("ed", "editor"), ("ann", "administrator")):
                subprocess.run(
                    [sys.executable, "-m", "btlang", "user", "add", name, "--role", role], env=environment,
                    input=f"{PASSWORD}\n", text=True, capture_output=True, check=True, timeout=LONG,
                )  # fmt: skip
            yield f"https://127.0.0.1:{port}"

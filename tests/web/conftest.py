"""The built page, and a robot with its server for a browser."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from hatch_build import build_page
from tests.server.doors import PASSWORD, Program, free_port
from tests.web.packages import LONG, ROOT, WEB


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


@pytest.fixture(scope="module")
def robot(page: Path) -> Iterator[str]:
    """The address of `btc robot up --serve` in the museum. Users: olga (operator), ed (editor), ann (administrator)."""
    with tempfile.TemporaryDirectory(prefix="bt") as folder:
        environment = {**os.environ, "XDG_DATA_HOME": f"{folder}/data", "XDG_RUNTIME_DIR": folder}
        port = str(free_port())
        world = str(ROOT / "examples" / "worlds" / "museum.toml")
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

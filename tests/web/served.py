"""A robot with its server, as people start it, for a browser."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from tests.server.doors import PASSWORD, Program, free_port
from tests.web.packages import LONG

USERS = (("vic", "viewer"), ("olga", "operator"), ("ed", "editor"), ("ann", "administrator"))


@contextmanager
def served(*options: str, prepare: Callable[[Path], object] | None = None) -> Iterator[str]:
    """The address of `btc robot up --serve`, with all `USERS`; `prepare` gets its data folder before."""
    with tempfile.TemporaryDirectory(prefix="bt") as folder:
        environment = {**os.environ, "XDG_DATA_HOME": f"{folder}/data", "XDG_RUNTIME_DIR": folder}
        if prepare is not None:
            prepare(Path(folder, "data"))
        port = str(free_port())
        with closing(Program(environment, "robot", "up", "--serve", "--port", port, *options)) as up:
            up.start("The robot 'robot' is up")
            assert up.process.stdout is not None
            assert up.process.stdout.readline() == f"The server is up: https://127.0.0.1:{port}\n"
            for name, role in USERS:
                subprocess.run(
                    [sys.executable, "-m", "btlang", "user", "add", name, "--role", role], env=environment,
                    input=f"{PASSWORD}\n", text=True, capture_output=True, check=True, timeout=LONG,
                )  # fmt: skip
            yield f"https://127.0.0.1:{port}"

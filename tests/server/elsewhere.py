"""A robot of another computer: a process here, in folders of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection

from tests.forked import popen
from tests.server import doors
from tests.server.doors import Door, Reply, child_of
from tests.task.layers import LONG, wait_until


class Elsewhere:
    """`btc robot up --join` on a computer of its own, as far as folders can be one."""

    def __init__(self, port: int, code: str, folder: Path | None = None) -> None:
        self.folder = folder or Path(tempfile.mkdtemp(prefix="bt"))
        self.environment = {
            **os.environ,
            "XDG_DATA_HOME": str(self.folder / "data"),
            "XDG_RUNTIME_DIR": str(self.folder),
        }
        words = ["robot", "up", "--join", f"wss://127.0.0.1:{port}", *(["--code", code] if code else [])]
        self.process = popen(
            [sys.executable, "-m", "btlang", *words], env=self.environment, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        self.lines: list[str] = []
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def told(self, words: str) -> None:
        wait_until(lambda: any(words in line for line in self.lines), 3 * LONG)  # two processes start before that

    def dialer(self) -> int:
        """The process that dials."""
        return child_of(self.process.pid)

    def tasks(self) -> str:
        """What its own computer lists."""
        return doors.btc(self.environment, "task", "list")

    def close(self) -> None:
        self.process.terminate()
        self.process.wait(LONG)
        self._thread.join(LONG)

    def _read(self) -> None:
        assert self.process.stdout is not None
        with self.process.stdout as lines:
            self.lines.extend(lines)


def btc(door: Door, *words: str) -> str:
    return doors.btc(door.environment, *words)


def invited(door: Door, name: str) -> str:
    return btc(door, "robot", "invite", name).split()[-1]


def listed(door: Door) -> dict[str, dict[str, Any]]:
    return {each["name"]: each for each in door.ask("GET", "/api/robots", **door.log_in("vic")).data["robots"]}


def is_up(door: Door, name: str) -> bool:
    return bool(listed(door).get(name, {}).get("up"))


def command(door: Door, name: str, **fields: Any) -> Reply:
    return door.ask("POST", "/api/commands", {"robot": name, **fields}, **door.log_in("olga"))


def in_background(work: Callable[[], Any]) -> tuple[threading.Thread, list[Any]]:
    results: list[Any] = []
    thread = threading.Thread(target=lambda: results.append(work()))
    thread.start()
    return thread, results


def asked_to_watch(socket: ClientConnection) -> int:
    """The number of the stream."""
    while not (asked := json.loads(socket.recv(LONG))).get("request"):
        pass
    return int(asked["stream"])

"""Stores of both kinds, and a robot that is up, with its command line."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.task.layer import TaskLayer
from btlang.task.store.task_store import TaskStore, open_store
from tests.task.layers import Btc, ask, robot_up
from tests.task.places import connection, new_place, server


@pytest.fixture(scope="session", autouse=True)
def _server_ends() -> Iterator[None]:
    yield
    if connection.cache_info().currsize:
        connection().close()
    if server.cache_info().currsize:
        server().cleanup()


@pytest.fixture(params=["sqlite", "postgres"])
def place(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Where no store is yet."""
    return new_place(request.param, tmp_path)


@pytest.fixture
def store(place: str) -> Iterator[TaskStore]:
    """An empty one."""
    with open_store(place) as opened:
        yield opened


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder of sockets and of what robots keep."""
    with tempfile.TemporaryDirectory() as folder:  # the path of a socket has to be short
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        monkeypatch.setenv("XDG_DATA_HOME", os.path.join(folder, "home"))
        yield Path(folder)


@pytest.fixture
def robot(short: Path) -> Iterator[TaskLayer]:
    """One that is up, and paused."""
    with robot_up(short / "data") as layer:
        ask(layer, "pause")
        yield layer


@pytest.fixture
def btc(capsys: pytest.CaptureFixture[str]) -> Btc:
    """Runs a command: its exit code, and what it prints anywhere."""

    def run(*words: str) -> tuple[int, str]:
        try:
            code = main(words)
        except SystemExit as ended:
            code = int(ended.code or 0)
        printed = capsys.readouterr()
        return code, printed.out + printed.err

    return run

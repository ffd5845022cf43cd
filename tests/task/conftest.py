"""Each test of a store runs on both kinds."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from btlang.task.store.task_store import TaskStore, open_store
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

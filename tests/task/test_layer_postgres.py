"""A robot whose tasks are on a server that goes away while it works, and comes back."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from btlang.run.events import Event, Printed
from btlang.task.store.database import store_error
from btlang.task.store.records import FINAL, Task, TaskState
from btlang.task.store.task_store import TaskStore

from .layers import layer_in, refusal, submit, task, wait_for, wait_until
from .places import connection, execute_at, new_place


class Server:
    """A store with a user of its own, whom the server can send away."""

    def __init__(self, folder: Path) -> None:
        whole = new_place("postgres", folder)
        self.user = "robot_" + whole.rpartition("%3D")[2]
        parts = urlsplit(whole)
        self.place = whole.replace(parts.netloc, f"{self.user}:@", 1)
        connection().execute(f"CREATE USER {self.user}")
        execute_at(whole, f"GRANT ALL ON SCHEMA {whole.rpartition('%3D')[2]} TO {self.user}")

    def goes(self) -> None:
        connection().execute(f"ALTER USER {self.user} NOLOGIN")
        ends = "SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity WHERE usename = %s"
        connection().execute(ends, (self.user,))

    def comes_back(self) -> None:
        connection().execute(f"ALTER USER {self.user} LOGIN")


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    monkeypatch.setattr("btlang.task.execution.executor._RETRY", 0.05)
    return Server(tmp_path)


class Printer:
    """What the missions printed."""

    policy = "inline"

    def __init__(self) -> None:
        self.texts: list[str] = []

    def __call__(self, event: Event) -> None:
        if isinstance(event, Printed):
            self.texts.append(event.text)


@pytest.mark.parametrize("restart", ["give up", "resume"])
def test_a_server_that_goes_away_during_a_task(restart: str, server: Server, tmp_path: Path) -> None:
    printer, troubles = Printer(), list[str]()
    with layer_in(tmp_path, store=server.place, sinks=lambda *_: [printer], trouble=troubles.append) as layer:
        first = submit(layer, "print a then wait 10 s then print b then wait 1 s", restart=restart)
        second = submit(layer, "print c")
        wait_until(lambda: printer.texts == ["a"])
        wait_for(layer, first, TaskState.UNDERWAY)
        server.goes()
        assert "BT195" in refusal(layer, "submit", text="print d")
        wait_until(lambda: printer.texts == ["a", "b"] and layer.executor.task is None)
        assert troubles
        server.comes_back()
        for number in (first, second):
            assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        states = [change.state for _, change in layer.store.changes(first)]
    assert states == [TaskState.QUEUED, TaskState.STANDBY, TaskState.UNDERWAY, TaskState.COMPLETED]
    assert printer.texts == ["a", "b", "c"]


def test_a_server_that_goes_away_between_tasks(server: Server, tmp_path: Path) -> None:
    with layer_in(tmp_path, store=server.place) as layer:
        server.goes()
        assert "BT195" in refusal(layer, "submit", text="wave")
        server.comes_back()
        number = submit(layer, "wave")
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED


def test_a_claim_of_which_nobody_was_told(tmp_path: Path, place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The connection is lost after the server has done it: the task isn't left behind."""
    claim, lost = TaskStore.claim, list[Task]()

    def claimed(store: TaskStore, now: float) -> Task | None:
        found = claim(store, now)
        if found is not None and not lost:
            lost.append(found)
            raise store_error(store.place, "the connection is lost")
        return found

    monkeypatch.setattr("btlang.task.execution.executor._RETRY", 0.05)
    monkeypatch.setattr(TaskStore, "claim", claimed)
    with layer_in(tmp_path, store=place) as layer:
        number = submit(layer, "wave")
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        assert task(layer, number).attempts == 2
    assert lost

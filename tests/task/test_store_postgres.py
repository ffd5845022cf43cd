"""What only a store on a server has: connections that are lost, passwords, a package that may be missing."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.store.database import StoreError
from btlang.task.store.postgres import Postgres
from btlang.task.store.records import TaskState
from btlang.task.store.task_store import TaskStore, open_store
from tests.task.places import a_task, connection, execute_at, new_place, server
from tests.task.test_store import reason


@pytest.fixture
def place(tmp_path: Path) -> str:
    return new_place("postgres", tmp_path)


@pytest.fixture
def store(place: str) -> Iterator[TaskStore]:
    with open_store(place) as opened:
        yield opened


def cut() -> None:
    """Ends all connections of this process to the server, but that of the tests."""
    named = f"btlang: process {os.getpid()} on %"
    # with the time-out it returns once they have ended
    connection().execute(
        "SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity WHERE application_name LIKE %s", (named,)
    )


def test_a_lost_connection_comes_back(store: TaskStore) -> None:
    task = store.add(a_task())
    cut()
    assert store.task(task.id) == task
    cut()
    assert store.add(a_task()).id == 2


def test_a_connection_that_is_lost_in_between_undoes_all(store: TaskStore) -> None:
    def interrupted() -> None:
        with store._database.transaction() as execute:
            execute("INSERT INTO setting (name, value) VALUES ('a', 'b')")
            cut()
            execute("INSERT INTO setting (name, value) VALUES ('c', 'd')")

    with pytest.raises(StoreError) as error:
        interrupted()
    assert reason(error) == "the connection is lost: the server ended it."
    assert (store.setting("a"), store.setting("c")) == ("", "")


def test_an_ownership_ends_with_its_connection(store: TaskStore, place: str) -> None:
    first = store.add(a_task())
    store.own()
    with open_store(place) as other:
        with pytest.raises(MissionError, match="BT197"):
            other.own()
        cut()
        other.own()
        for call in (store.own, lambda: store.claim(200.0)):
            with pytest.raises(MissionError, match="BT197"):
                call()
        assert store.task(first.id) == first
    claimed = store.claim(200.0)
    assert claimed is not None
    with open_store(place) as other, pytest.raises(MissionError, match="BT197"):
        other.own()


def test_stores_in_two_schemas_have_two_owners(store: TaskStore, tmp_path: Path) -> None:
    with open_store(new_place("postgres", tmp_path)) as other:
        store.own()
        other.own()
        other.add(a_task())
        assert store.tasks() == []


@pytest.mark.parametrize(
    ("code", "told"),
    [("53100", "the disk is full."), ("42501", "the user may not do this."), ("22000", "colour is unknown.")],
)
def test_what_the_server_refuses(store: TaskStore, place: str, code: str, told: str) -> None:
    store.add(a_task())
    execute_at(place, (
        "CREATE FUNCTION refuse() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
        f" RAISE EXCEPTION USING ERRCODE = '{code}', MESSAGE = 'colour is unknown'; END $$;"
        "CREATE TRIGGER refuse BEFORE INSERT ON change EXECUTE FUNCTION refuse()"
    ))  # fmt: skip
    for call in (lambda: store.add(a_task()), lambda: store.claim(200.0)):
        with pytest.raises(StoreError) as error:
            call()
        assert reason(error) == told
    execute_at(place, "DROP TRIGGER refuse ON change")
    assert [task.state for task in store.tasks()] == [TaskState.QUEUED]
    assert store.add(a_task()).id == 2


def test_a_store_that_is_locked_for_too_long(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.task.store.postgres.PATIENCE", 0.1)
    with open_store(place) as store, open_store(place) as other:
        task = store.add(a_task())
        with other._database.transaction() as execute:
            execute("SELECT id FROM task FOR UPDATE")
            with pytest.raises(StoreError) as error:
                store.amend(task.id, priority=1)
            assert reason(error) == "another process has locked it for too long."
        assert store.amend(task.id, priority=1) == task.replace(priority=1)


def test_a_task_that_is_locked_is_not_overlooked(store: TaskStore) -> None:
    """Another one is claimed meanwhile; where there's no other one, `claim` waits."""
    first, second = store.add(a_task()), store.add(a_task())
    with ThreadPoolExecutor(1) as thread:
        with store._database.transaction() as execute:
            execute("UPDATE task SET position = 7 WHERE id = ?", (first.id,))
            claimed = store.claim(200.0)
            assert (claimed and claimed.id) == second.id
            waiting = thread.submit(store.claim, 200.0)
            named = f"btlang: process {os.getpid()} on %"
            query = "SELECT 1 FROM pg_stat_activity WHERE wait_event_type = 'Lock' AND application_name LIKE %s"
            while not (waiting.done() or connection().execute(query, (named,)).fetchone()):
                pass
        claimed = waiting.result()
    assert (claimed and (claimed.id, claimed.position)) == (first.id, 7)


def test_a_server_that_cannot_be_reached(tmp_path: Path) -> None:
    for url, told in (
        (
            f"postgresql://ada:secret@/x?host={tmp_path}&password=secret",
            "there's no connection: No such file or directory.",
        ),
        ("postgresql://ada:sec%zzret@localhost/x", "its URL isn't valid."),
        (server().get_uri(database="nothing"), 'there\'s no connection: database "nothing" does not exist.'),
    ):
        with pytest.raises(StoreError) as error:
            open_store(url)
        assert reason(error) == told
        assert "sec" not in str(error.value)


@pytest.mark.parametrize(
    ("url", "shown"),
    [
        ("postgresql://ada:secret@robot.example:5433/db?sslmode=require", "postgresql://ada@robot.example:5433/db"),
        ("postgresql://ada:secret@a:1,b:2/db", "postgresql://..."),
        ("postgres:///db?user=ada&password=secret", "postgres:///db"),
    ],
)
def test_a_password_is_not_shown(url: str, shown: str) -> None:
    assert Postgres(url).place == shown


def test_other_tables_may_be_beside(place: str) -> None:
    execute_at(place, "CREATE TABLE photo (name TEXT)")
    with open_store(place) as store:
        store.add(a_task())
    execute_at(place, "INSERT INTO photo VALUES ('a')")


def test_durability_is_that_of_the_database(place: str) -> None:
    for durable, commit in ((False, "off"), (True, "on")):
        with open_store(place, durable) as store, store._database.transaction() as execute:
            assert execute("SHOW synchronous_commit") == [(commit,)]


def test_the_package_may_be_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(MissionError) as error:
        open_store("postgresql://localhost/x")
    assert str(error.value).endswith(
        "BT189: A task store in PostgreSQL needs the Python package psycopg, which isn't installed.\n"
        "  Install it: pip install 'btlang[postgres]'"
    )


def test_files_need_no_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with open_store(str(tmp_path / "tasks.db")) as store:
        assert store.add(a_task()).id == 1

"""Places that are no store, stores that are damaged, older or newer, and backups."""

from __future__ import annotations

import os
import re
import shutil
import sqlite3
import stat
import tempfile
import threading
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.store import migrations
from btlang.task.store.backup import restore_backup
from btlang.task.store.database import StoreError
from btlang.task.store.records import Act, LibraryKind, Revision, TaskChange, TaskState
from btlang.task.store.sqlite import Sqlite
from btlang.task.store.task_store import TaskStore, open_store
from tests.task.places import a_task, closed, execute_at, program
from tests.task.test_store import FULL, PLAN, reason

VERSION_1 = Path(__file__).with_name("store_version_1.sql").read_text(encoding="utf-8")
"""What `.dump` of the sqlite3 shell prints of a store of version 1."""


def why_not(place: str | Path) -> str:
    """Why a store can't be opened."""
    with pytest.raises(StoreError) as error:
        open_store(str(place))
    return reason(error)


def test_a_file_that_is_no_store(tmp_path: Path) -> None:
    text = tmp_path / "mission.txt"
    text.write_text("wave then nod\n" * 100, encoding="utf-8")
    assert why_not(text) == "it isn't a store of btlang."
    assert text.read_text(encoding="utf-8") == "wave then nod\n" * 100
    other = tmp_path / "other.db"
    execute_at(str(other), "CREATE TABLE photo (name TEXT)")
    assert why_not(other) == "it has tables, but it isn't a store of btlang."
    execute_at(str(other), "CREATE TABLE version (major TEXT)")
    assert why_not(other) == "its version can't be read; perhaps it isn't a store of btlang."


def test_no_file_can_be_there(tmp_path: Path) -> None:
    assert why_not(tmp_path) == "it's a folder."
    assert why_not(tmp_path / "no" / "x.db") == f"the folder {tmp_path / 'no'} doesn't exist."
    assert why_not("a\0b") == "this can't be the name of a file."
    assert why_not("mysql://ada:secret@host/db") == "it must be a file or a postgresql:// URL."


@pytest.mark.parametrize("is_there", [False, True])
def test_a_folder_that_cannot_be_written(is_there: bool) -> None:
    folder = Path(tempfile.mkdtemp())  # which others may enter, other than that of pytest
    try:
        place = folder / "tasks.db"
        if is_there:
            open_store(str(place)).close()
        folder.chmod(0o555)
        printed, _ = program("powerless", str(place)).communicate()
        assert re.fullmatch(rf"BT195 (nothing can be written in the folder {folder}|it can't be written)\.\n", printed)
        assert [path.name for path in folder.iterdir()] == ["tasks.db"] * is_there
    finally:
        folder.chmod(0o755)
        shutil.rmtree(folder)


@pytest.mark.parametrize("damage", ["head", "middle", "cut", "index"])
def test_a_damaged_file(tmp_path: Path, damage: str) -> None:
    place = tmp_path / "tasks.db"
    with open_store(str(place)) as store:
        for _ in range(40):
            store.add(a_task("wave " * 50))
    whole = place.read_bytes()
    size = len(whole) // 2
    if damage == "index":
        execute_at(
            str(place), "PRAGMA writable_schema = 1; UPDATE sqlite_master SET rootpage = 9999 WHERE type = 'index'"
        )
    else:
        middle = whole[:size] + bytes(range(256)) * 16 + whole[size + 4096 :]
        place.write_bytes({"head": b"\0" * 64 + whole[64:], "middle": middle, "cut": whole[:size]}[damage])
    assert why_not(place) == ("it isn't a store of btlang." if damage == "head" else "it's damaged.")
    place.write_bytes(whole)
    with open_store(str(place)) as store:
        assert len(store.tasks()) == 40


def test_other_tables(store: TaskStore, place: str) -> None:
    store.close()
    execute_at(place, "ALTER TABLE act ADD COLUMN colour TEXT")
    assert why_not(place) == "its table 'act' has other columns than it should."
    execute_at(place, "DROP TABLE act")
    assert why_not(place) == "its table 'act' is missing."


def test_no_version(store: TaskStore, place: str) -> None:
    store.add(a_task())
    store.close()
    execute_at(place, "UPDATE version SET number = 0")
    assert why_not(place) == "its version can't be read; perhaps it isn't a store of btlang."
    execute_at(place, "DROP TABLE version")
    assert why_not(place) == "it has tables, but it isn't a store of btlang."


def test_a_newer_store_is_left_alone(store: TaskStore, place: str) -> None:
    store.add(a_task())
    store.close()
    known = len(migrations.MIGRATIONS)
    execute_at(place, f"ALTER TABLE task ADD COLUMN colour TEXT; UPDATE version SET number = {known + 1}")
    before = Path(place).read_bytes() if os.path.exists(place) else b""
    with pytest.raises(MissionError) as error:
        open_store(place)
    [told] = error.value.diagnostics
    assert told.code == "BT196"
    assert told.message.endswith(f"it has version {known + 1}, and this one knows versions up to {known}.")
    assert (Path(place).read_bytes() if before else b"") == before
    execute_at(place, f"ALTER TABLE task DROP COLUMN colour; UPDATE version SET number = {known}")
    with open_store(place) as again:
        assert len(again.tasks()) == 1


def test_version_1_is_read(place: str) -> None:
    execute_at(place, VERSION_1)
    with open_store(place) as store:
        assert store.tasks() == [a_task().replace(id=2), FULL.replace(id=1)]
        assert store.changes() == [
            (1, TaskChange(1, 1.25, TaskState.BLOCKED, "submitted", "ada")),
            (2, TaskChange(2, 100.0, TaskState.QUEUED, "", "ada")),
        ]
        assert store.schedules() == [PLAN.replace(id=1)]
        assert store.revisions("tour") == [
            Revision("tour", 1, "wave", "ada", 1.0),
            Revision("tour", 2, "", "bo", 2.0, deleted=True),
        ]
        assert store.acts() == [Act(3.0, "ada", "say", "it's", "said")]
        assert store.setting("paused") == "no"
        assert store.add(a_task()).id == 3
        assert store.changes(after=2)[0][0] == 3


def test_the_steps_that_were_released_are_the_same() -> None:
    with closed(sqlite3.connect(":memory:")) as dumped, closed(sqlite3.connect(":memory:")) as made:
        dumped.executescript(VERSION_1)
        for statement in migrations.MIGRATIONS[0]:
            made.execute(statement)
        query = "SELECT type, name, sql FROM sqlite_master ORDER BY type, name"
        assert made.execute(query).fetchall() == dumped.execute(query).fetchall()


NEXT = ("ALTER TABLE setting ADD COLUMN person TEXT NOT NULL DEFAULT ''", "UPDATE setting SET value = 'now ' || value")


def test_an_older_store_is_migrated(place: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    execute_at(place, VERSION_1)
    old = str(tmp_path / "old.backup")
    with open_store(place) as store:
        store.backup(old)
    monkeypatch.setattr(migrations, "MIGRATIONS", [*migrations.MIGRATIONS, NEXT])
    for _ in range(2):
        with open_store(place) as store:
            assert store.setting("paused") == "now no"
            assert len(store.tasks()) == 2
    before = Path(old).read_bytes()
    restored = str(tmp_path / "restored.db")
    monkeypatch.setattr("btlang.task.store.backup.MIGRATIONS", migrations.MIGRATIONS)
    restore_backup(old, restored)
    assert Path(old).read_bytes() == before
    with open_store(restored) as store:
        assert store.setting("paused") == "now no"
        assert store.tasks()[1].mission == FULL.mission
    monkeypatch.undo()
    with pytest.raises(MissionError, match="BT196"):
        open_store(place)


def test_a_migration_that_fails_changes_nothing(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    execute_at(place, VERSION_1)
    known, tables_of = len(migrations.MIGRATIONS), migrations.tables_of
    monkeypatch.setattr(migrations, "MIGRATIONS", [*migrations.MIGRATIONS, (*NEXT, "UPDATE colour SET red = 1")])
    monkeypatch.setattr(migrations, "tables_of", lambda steps: tables_of(steps[:known]))  # no database has the new step
    with pytest.raises(StoreError, match="colour"):
        open_store(place)
    monkeypatch.undo()
    with open_store(place) as store:
        assert store.setting("paused") == "no"
        assert len(store.tasks()) == 2


def test_a_backup_is_one_moment_of_a_store_in_use(store: TaskStore, tmp_path: Path) -> None:
    ended = threading.Event()

    def work() -> None:
        while not ended.is_set():
            task = store.add(a_task())
            store.change(task.id, [TaskState.QUEUED], TaskState.FAILED, time=1.0)

    writer = threading.Thread(target=work)
    writer.start()
    try:
        paths = [str(tmp_path / f"{at}.backup") for at in range(4)]
        for path in paths:
            store.backup(path)
    finally:
        ended.set()
        writer.join()
    sizes = []
    for path in paths:
        restored = path + ".db"
        restore_backup(path, restored)
        with open_store(restored) as copied:
            changes, tasks = [change for _, change in copied.changes()], copied.tasks()
            assert [task.id for task in tasks] == list(range(1, len(tasks) + 1))
            assert {change.task: change.state for change in changes} == {task.id: task.state for task in tasks}
            assert copied.add(a_task()).id == len(tasks) + 1
            assert copied.tasks(limit=len(tasks)) == [task.replace(state=task.state) for task in tasks]
            sizes.append(len(changes))
    assert sizes == sorted(sizes)
    assert sizes[-1] < len(store.changes())


def test_a_backup_can_be_read_where_nothing_can_be_written(store: TaskStore, tmp_path: Path) -> None:
    store.put_text("tour", "wave", "ada", 1.0)
    backup = tmp_path / "backup"
    store.backup(str(backup))
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith("backup")] == ["backup"]
    assert backup.read_bytes()[18:20] == b"\1\1"  # not in WAL mode, which needs files beside it
    backup.chmod(stat.S_IRUSR)
    restored = str(tmp_path / "restored.db")
    restore_backup(str(backup), restored)
    with open_store(restored) as copied:
        assert copied.texts() == store.texts()


def test_a_backup_has_every_revision(store: TaskStore, tmp_path: Path) -> None:
    for number in range(1100):  # more than are copied at once
        store.put_text("tour", f"wait {number} s", "ada", 1.0)
    store.put_text("tour", "start = { x = 1, y = 1 }", "ada", 1.0, kind=LibraryKind.WORLD)
    backup, restored = str(tmp_path / "backup"), str(tmp_path / "restored.db")
    store.backup(backup)
    restore_backup(backup, restored)
    with open_store(restored) as copied:
        assert [copied.revisions("tour", kind) for kind in LibraryKind] == [
            store.revisions("tour", kind) for kind in LibraryKind
        ]


def test_a_backup_overwrites_nothing(store: TaskStore, place: str, tmp_path: Path) -> None:
    store.add(a_task())
    taken = tmp_path / "taken"
    taken.write_text("mine", encoding="utf-8")
    with pytest.raises(StoreError) as error:
        store.backup(str(taken))
    assert reason(error) == "there's such a file already."
    assert taken.read_text(encoding="utf-8") == "mine"
    with pytest.raises(StoreError) as error:
        store.backup(str(tmp_path / "no" / "backup"))
    assert reason(error) == f"the folder {tmp_path / 'no'} doesn't exist."
    store.backup(str(tmp_path / "backup"))
    with pytest.raises(StoreError) as error:
        restore_backup(str(tmp_path / "backup"), place)
    assert reason(error) == "it isn't empty, so a backup can't be restored there."
    assert len(store.tasks()) == 1


def test_what_is_no_backup_is_not_restored(store: TaskStore, place: str, tmp_path: Path) -> None:
    text, empty = tmp_path / "text", tmp_path / "empty"
    text.write_text("wave\n" * 200, encoding="utf-8")
    empty.touch()
    for path, told in (
        (text, "it isn't a store of btlang."),
        (empty, "it isn't a store of btlang."),
        (tmp_path / "no", "there's no such file."),
    ):
        with pytest.raises(StoreError) as error:
            restore_backup(str(path), place)
        assert reason(error) == told
        assert str(path) in error.value.diagnostics[0].message
    assert not (tmp_path / "no").exists()
    assert store.tasks() == []


def test_a_full_database(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    connect = Sqlite._connect

    def small(database: Sqlite) -> sqlite3.Connection:
        connection = connect(database)
        connection.execute("PRAGMA max_page_count = 40")
        return connection

    with open_store(str(tmp_path / "tasks.db")) as store:
        store.add(a_task())
        store._database._idle.pop().close()
        with monkeypatch.context() as patch:
            patch.setattr(Sqlite, "_connect", small)
            with pytest.raises(StoreError) as error:
                store.add(a_task("wave " * 100_000))
            assert reason(error) == "the disk is full."
        store._database._idle.pop().close()
        assert [len(store.tasks()), len(store.changes())] == [1, 1]
        assert store.add(a_task("wave " * 100_000)).id == 2


def test_a_store_that_is_locked_for_too_long(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.task.store.sqlite.PATIENCE", 0.05)
    place = str(tmp_path / "tasks.db")
    with open_store(place) as store, closed(sqlite3.connect(place, isolation_level=None)) as other:
        task = store.add(a_task())
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(StoreError) as error:
            store.add(a_task())
        assert reason(error) == "another process has locked it for too long."
        assert store.tasks() == [task]
        other.execute("ROLLBACK")
        assert store.add(a_task()).id == 2


def test_durability_is_that_of_the_database(tmp_path: Path) -> None:
    for durable, synchronous in ((False, 1), (True, 2)):
        with open_store(str(tmp_path / "tasks.db"), durable) as store:
            store.add(a_task())
            connection = store._database._idle[0]
            assert connection.execute("PRAGMA synchronous").fetchone() == (synchronous,)
            assert connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)


def test_one_owner_whatever_the_file_is_called(tmp_path: Path) -> None:
    place, link = tmp_path / "tasks.db", tmp_path / "link.db"
    link.symlink_to(place)
    with open_store(str(place)) as store, open_store(str(link)) as other:
        store.own()
        with pytest.raises(MissionError, match="BT197"):
            other.own()
        assert other.add(a_task()) == store.task(1)

"""Copies of a database in one SQLite file, written while it's in use, and how they become a database again."""

from __future__ import annotations

import os
from contextlib import suppress

from btlang.diagnostics.files import os_error_reason
from btlang.task.store.database import Database, Mode, store_error
from btlang.task.store.migrations import MIGRATIONS, migrate, open_database, stored_version, tables_of
from btlang.task.store.rows import marks
from btlang.task.store.sqlite import Sqlite

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from btlang.task.store.database import Execute
    from btlang.task.store.migrations import Step

_BATCH = 1_000  # rows of a statement, which may have 32,766 values


def write_backup(
    database: Database, path: str, steps: Sequence[Step] | None = None, without: Collection[str] = ()
) -> None:
    """Write all into a new file for its owner alone, as it is at one moment, `without` the rows of some tables.

    `steps` are those of `migrate`. Raises StoreError, also if there's such a file already.
    """
    if os.path.lexists(path):
        raise store_error(path, "there's such a file already")
    part = f"{path}.{os.getpid()}.part"
    try:
        _remove(part)  # of a process that was killed
        _write(database, part, path, steps, without)
        os.rename(part, path)
    except OSError as error:
        raise store_error(path, os_error_reason(error)) from error
    finally:
        with suppress(OSError):
            _remove(part)


def restore_backup(path: str, place: str) -> None:
    """Fill an empty store with what `Store.backup` wrote.

    Raises MissionError as `open_store` does, for both places, and StoreError if anything is in that store; then it
    stays as it is.
    """
    _check_file(path)
    target = open_database(place, durable=True)
    try:
        fill_from_backup(target, path)
    finally:
        target.close()


def fill_from_backup(
    target: Database, path: str, steps: Sequence[Step] | None = None, without: Collection[str] = ()
) -> None:
    """Fill an empty database with what `write_backup` wrote, also for an older version of it; `steps` and `without` are
    as there. Raises MissionError (BT195, BT196) for the file, and StoreError if anything is in the database; then it
    stays as it is.
    """
    import tempfile

    _check_file(path)
    with tempfile.TemporaryDirectory() as folder:
        backup = Sqlite(path)
        copied = Sqlite(os.path.join(folder, "backup"))  # an older one has to be migrated, and stays as it is
        try:
            backup.check()
            with backup.transaction(Mode.READ) as execute:
                if not stored_version(backup, execute, steps):
                    raise store_error(path, "it isn't a store of btlang")
            backup.copy(copied.path)
            migrate(copied, steps)
            with copied.transaction(Mode.READ) as read, target.transaction(Mode.ALONE) as write:
                if any(write(f"SELECT 1 FROM {table} LIMIT 1") for table in _tables(steps) if table != "counter"):
                    raise store_error(target.place, "it isn't empty, so a backup can't be restored there")
                _copy(read, write, steps, without)
        finally:
            for database in (backup, copied):
                database.close()


def _check_file(path: str) -> None:
    if not os.path.isfile(path):
        raise store_error(path, "there's no such file")


def _write(database: Database, part: str, path: str, steps: Sequence[Step] | None, without: Collection[str]) -> None:
    with suppress(FileNotFoundError):  # of the folder: the error of the database is better
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))  # it has all that the store has
    target = Sqlite(part, durable=True, shown=path)
    try:
        migrate(target, steps)
        with database.transaction(Mode.READ) as read, target.transaction() as write:
            _copy(read, write, steps, without)
    finally:
        target.close()
    target.seal()


def _tables(steps: Sequence[Step] | None) -> dict[str, list[str]]:
    """Return the tables, with their columns, that a copy has to fill."""
    tables = tables_of(MIGRATIONS if steps is None else steps)
    return {table: columns for table, columns in tables.items() if table != "version"}


def _copy(read: Execute, write: Execute, steps: Sequence[Step] | None, without: Collection[str]) -> None:
    """Copy all rows from one store into another one, of the same version; the counters in the order of
    `TaskStore.add`.
    """
    tables = _tables(steps)
    if "counter" in tables:  # which has rows from its beginning
        del tables["counter"]
        for name, value in read("SELECT name, value FROM counter ORDER BY name DESC"):
            write("UPDATE counter SET value = ? WHERE name = ?", (value, name))
    for table in [name for name in tables if name not in without]:
        columns = tables[table]
        listed = ", ".join(columns)
        for at in range(0, read(f"SELECT count(*) FROM {table}")[0][0], _BATCH):
            rows = read(
                f"SELECT {listed} FROM {table} ORDER BY {', '.join(columns[:3])} LIMIT ? OFFSET ?", (_BATCH, at)
            )
            every = ", ".join([f"({marks(len(columns))})"] * len(rows))
            write(f"INSERT INTO {table} ({listed}) VALUES {every}", [value for row in rows for value in row])


def _remove(path: str) -> None:
    for ending in ("", "-wal", "-shm"):
        with suppress(FileNotFoundError):
            os.remove(path + ending)

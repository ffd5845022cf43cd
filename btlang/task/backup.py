"""Copies of a store in one SQLite file, written while the store is in use, and how they become a store again."""

from __future__ import annotations

import os
from contextlib import suppress

from btlang.diagnostics.reading import reason_of
from btlang.task.database import Database, Mode, store_error
from btlang.task.migrations import MIGRATIONS, migrate, open_database, stored_version, tables_of
from btlang.task.rows import marks
from btlang.task.sqlite import Sqlite

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.task.database import Execute

_BATCH = 1_000  # rows of a statement, which may have 32,766 values


def write_backup(database: Database, path: str) -> None:
    """See `Store.backup`."""
    if os.path.lexists(path):
        raise store_error(path, "there's such a file already")
    part = f"{path}.{os.getpid()}.part"
    try:
        _remove(part)  # of a process that was killed
        _write(database, part, path)
        os.rename(part, path)
    except OSError as error:
        raise store_error(path, reason_of(error)) from error
    finally:
        with suppress(OSError):
            _remove(part)


def restore_backup(path: str, place: str) -> None:
    """Fills an empty store with what `Store.backup` wrote. Raises MissionError as `open_store` does, for both places,
    and StoreError if anything is in that store; then it stays as it is.
    """
    import tempfile

    if not os.path.isfile(path):
        raise store_error(path, "there's no such file")
    with tempfile.TemporaryDirectory() as folder:
        backup = Sqlite(path)
        copied = Sqlite(os.path.join(folder, "backup"))  # an older one has to be migrated, and stays as it is
        target = open_database(place, durable=True)
        try:
            backup.check()
            with backup.transaction(Mode.READ) as execute:
                if not stored_version(backup, execute):
                    raise store_error(path, "it isn't a store of btlang")
            backup.copy(copied.path)
            migrate(copied)
            with copied.transaction(Mode.READ) as read, target.transaction(Mode.ALONE) as write:
                if any(write(f"SELECT 1 FROM {table} LIMIT 1") for table in _filled()):
                    raise store_error(target.place, "it isn't empty, so a backup can't be restored there")
                _copy(read, write)
        finally:
            for database in (backup, copied, target):
                database.close()


def _write(database: Database, part: str, path: str) -> None:
    with suppress(FileNotFoundError):  # of the folder, which the database tells better
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))  # it has all that the store has
    target = Sqlite(part, durable=True, shown=path)
    try:
        migrate(target)
        with database.transaction(Mode.READ) as read, target.transaction() as write:
            _copy(read, write)
    finally:
        target.close()
    target.seal()


def _filled() -> dict[str, list[str]]:
    """The tables, with their columns, that have no rows before a store is used."""
    tables = tables_of(MIGRATIONS)
    return {table: columns for table, columns in tables.items() if table not in ("version", "counter")}


def _copy(read: Execute, write: Execute) -> None:
    """All rows from one store into another one, of the same version; the counters in the order of `Store.add`."""
    for name, value in read("SELECT name, value FROM counter ORDER BY name DESC"):
        write("UPDATE counter SET value = ? WHERE name = ?", (value, name))
    for table, columns in _filled().items():
        listed = ", ".join(columns)
        for at in range(0, read(f"SELECT count(*) FROM {table}")[0][0], _BATCH):
            rows = read(f"SELECT {listed} FROM {table} ORDER BY 1, 2 LIMIT ? OFFSET ?", (_BATCH, at))
            every = ", ".join([f"({marks(len(columns))})"] * len(rows))
            write(f"INSERT INTO {table} ({listed}) VALUES {every}", [value for row in rows for value in row])


def _remove(path: str) -> None:
    for ending in ("", "-wal", "-shm"):
        with suppress(FileNotFoundError):
            os.remove(path + ending)

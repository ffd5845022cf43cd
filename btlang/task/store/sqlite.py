"""A store in one file: SQLite, in WAL mode."""

from __future__ import annotations

import os
import sqlite3
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext, suppress

from btlang.diagnostics.files import os_error_reason
from btlang.task.store.database import OWNED, PATIENCE, Database, Mode, StoreError, owned_error, store_error

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, ClassVar

    from btlang.task.store.database import Execute

if sys.platform == "win32":
    import msvcrt

    def _lock(file: int) -> None:
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(file: int) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


_REASONS = {
    "SQLITE_NOTADB": "it isn't a store of btlang",
    "SQLITE_CORRUPT": "it's damaged",
    "SQLITE_FULL": "the disk is full",
    "SQLITE_BUSY": "another process has locked it for too long",
    "SQLITE_LOCKED": "another process has locked it for too long",
    "SQLITE_READONLY": "it can't be written",
    "SQLITE_PERM": "it can't be written",
    "SQLITE_IOERR_WRITE": "it can't be written: the disk may be full",
    "SQLITE_IOERR": "the disk can't be read or written",
    "SQLITE_TOOBIG": "a text is too long",
}
"""The reasons by the name of the error, or how that begins."""


class Sqlite(Database):
    """A store in one SQLite file.

    `durable`: what is changed is on the disk before the call returns, so a loss of power doesn't take it either.
    `shown` is the name for messages.
    """

    begin: ClassVar = {Mode.READ: ("BEGIN",), Mode.WRITE: ("BEGIN IMMEDIATE",), Mode.ALONE: ("BEGIN IMMEDIATE",)}
    row_lock: ClassVar = {Mode.WRITE: "", Mode.ALONE: ""}  # who writes is alone
    is_shared = False

    def __init__(self, place: str, durable: bool = False, shown: str = "") -> None:
        super().__init__(shown or place, (sqlite3.Error,))
        self.path = os.path.realpath(place)  # so that it has one lock, whatever name it was opened by
        self._synchronous = "FULL" if durable else "NORMAL"
        self._writing = threading.Lock()
        self._owned: int | None = None
        self._owning = threading.Lock()

    def prepare(self) -> None:
        """Turn the WAL mode on, in which nobody who reads waits for those who write."""
        until = time.monotonic() + PATIENCE
        while True:
            try:
                self._outside("PRAGMA journal_mode = WAL")
                return
            except StoreError as error:  # SQLite doesn't wait here for another process that makes the store, too
                is_busy = getattr(error.__cause__, "sqlite_errorname", "").startswith("SQLITE_BUSY")
                if not is_busy or time.monotonic() > until:
                    raise
            time.sleep(0.01)

    def check(self) -> None:
        """Raise StoreError if the file is damaged."""
        with self.transaction(Mode.READ) as execute:
            [[found]] = execute("PRAGMA quick_check(1)")
        if found != "ok":
            raise store_error(self.place, _REASONS["SQLITE_CORRUPT"])

    def copy(self, path: str) -> None:
        """Write all into a new file, as it is at this moment. Raises StoreError."""
        self._outside("VACUUM INTO ?", [path])

    def seal(self) -> None:
        """End the WAL mode of a file that nobody uses, so that it can be read where nothing can be written."""
        self._outside("PRAGMA journal_mode = DELETE")

    def tables(self, execute: Execute) -> dict[str, list[str]]:
        return columns(execute)

    def own(self) -> None:
        with self._owning:
            if self._owned is not None and self._owned in OWNED:
                return
            path = self.path + ".lock"
            try:
                file = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o644)
            except OSError as error:
                raise store_error(self.place, f"{path} can't be written: {os_error_reason(error)}") from None
            try:
                _lock(file)
            except OSError:
                owner = os.pread(file, 20, 0).decode("ascii", "replace") if hasattr(os, "pread") else ""
                os.close(file)
                raise owned_error(self.place, f"process {owner.strip()}" if owner else "another process") from None
            with suppress(OSError):  # for the message alone
                os.ftruncate(file, 0)
                os.write(file, b"%d\n" % os.getpid())
            self._owned = file
            OWNED.add(file)

    def disown(self) -> None:
        with self._owning:
            if self._owned is not None and self._owned in OWNED:
                OWNED.remove(self._owned)
                os.close(self._owned)
            self._owned = None

    def _connect(self) -> sqlite3.Connection:
        # one thread at a time uses a connection, but not always the same one
        connection = sqlite3.connect(self.path, timeout=PATIENCE, isolation_level=None, check_same_thread=False)
        connection.execute(f"PRAGMA synchronous = {self._synchronous}")
        return connection

    def _run(self, connection: Any, sql: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
        rows: list[tuple[Any, ...]] = connection.execute(sql, values).fetchall()
        return rows

    def _is_lost(self, connection: Any) -> bool:
        return False

    def _is_free(self, connection: Any) -> bool:
        return not connection.in_transaction

    def _turn(self, mode: Mode) -> AbstractContextManager[object]:
        # between processes SQLite waits by trying again and again, which between threads a lock does better
        return nullcontext() if mode is Mode.READ else self._writing

    def _outside(self, sql: str, values: Sequence[object] = ()) -> None:
        """Execute a statement that has to be outside of transactions."""
        try:
            connection = self._connect()
            try:
                self._run(connection, sql, values)
            finally:
                connection.close()
        except self._errors as error:
            raise self._problem(error) from error

    def _reason(self, error: Exception) -> str:
        name = getattr(error, "sqlite_errorname", "")
        if name.startswith("SQLITE_CANTOPEN"):
            return self._why_not_opened()
        for beginning, reason in _REASONS.items():
            if name.startswith(beginning):
                return reason
        return str(error)

    def _why_not_opened(self) -> str:
        folder = os.path.dirname(self.path)
        if os.path.isdir(self.path):
            return "it's a folder"
        if not os.path.isdir(folder):
            return f"the folder {folder} doesn't exist"
        if not os.access(folder, os.W_OK, effective_ids=os.access in os.supports_effective_ids):
            return f"nothing can be written in the folder {folder}"
        return "it can't be opened"


def columns(execute: Execute) -> dict[str, list[str]]:
    """Return the columns of each table of an SQLite database."""
    found: dict[str, list[str]] = {}
    tables = "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite\\_%' ESCAPE '\\'"
    for table, column in execute(f"SELECT t.name, c.name FROM ({tables}) t, pragma_table_info(t.name) c"):
        found.setdefault(table, []).append(column)
    return found

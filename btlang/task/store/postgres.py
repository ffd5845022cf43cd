"""A store in a schema of a PostgreSQL database, through psycopg, which is imported when it is used."""

from __future__ import annotations

import os
import socket
import threading
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from urllib.parse import urlsplit

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.task.store.database import OWNED, PATIENCE, Database, Mode, owned_error, store_error
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, ClassVar

    from btlang.task.store.database import Execute

SCHEMES = ("postgresql", "postgres")
_CHANGING, _OWNING = 0x62746C01, 0x62746C02
"""The numbers of advisory locks, together with the name of the schema."""
_NAME = "btlang: "
_SILENT = 30  # seconds: who says nothing for so long has lost the connection
_REASONS = {
    "08": "the connection is lost",
    "23": "its rows contradict each other",
    "25006": "it can't be written",
    "28": "the user or the password is wrong",
    "3D": "there's no such database",
    "40": "others changed it at the same time",
    "42501": "the user may not do this",
    "53100": "the disk is full",
    "53300": "it has too many connections",
    "55P03": "another process has locked it for too long",
    "57P01": "the connection is lost: the server ended it",
    "57P02": "the connection is lost: the server crashed",
    "57P03": "the server isn't ready yet",
    "XX001": "it's damaged",
    "XX002": "it's damaged",
}
"""The reasons by the code of the error, or how that begins."""


class Postgres(Database):
    """A store in a schema of a PostgreSQL database.

    `durable`: what is changed is on the server's disk before the call returns. Without it, it's in the server's memory:
    the end of this process never takes it, but a crash of the server may take its last half second.

    Raises MissionError: BT189 if psycopg isn't installed, BT195 if the URL isn't one.
    """

    begin: ClassVar = {
        Mode.READ: ("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY",),
        Mode.WRITE: ("BEGIN",),
        Mode.ALONE: ("BEGIN", f"SELECT pg_advisory_xact_lock({_CHANGING}, hashtext(current_schema()))"),
    }
    row_lock: ClassVar = {Mode.WRITE: " FOR UPDATE SKIP LOCKED", Mode.ALONE: " FOR UPDATE"}
    is_shared = True

    def __init__(self, place: str, durable: bool = False) -> None:
        try:
            import psycopg
            from psycopg.conninfo import conninfo_to_dict
        except ImportError:
            raise MissionError([diagnostic("BT189", NOWHERE)]) from None
        super().__init__(_without_secrets(place), (psycopg.Error,))
        self._psycopg = psycopg
        try:
            given = conninfo_to_dict(place)
        except psycopg.Error:  # whose text may have a part of the password
            raise store_error(self.place, "its URL isn't valid") from None
        self._parameters: dict[str, Any] = {**_defaults(), **given}
        self._settings = _settings(durable)
        self._owner: Any = None
        self._owned = 0
        self._owning = threading.Lock()

    def tables(self, execute: Execute) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        of = "SELECT table_name, column_name FROM information_schema.columns WHERE table_schema = current_schema()"
        for table, column in execute(of):
            found.setdefault(table, []).append(column)
        return found

    def own(self) -> None:
        with self._owning:
            try:
                self._own()
            except self._errors as error:
                raise self._problem(error) from error

    def disown(self) -> None:
        with self._owning:
            self._disown()

    def _disown(self) -> None:
        if self._owner is not None:
            OWNED.discard(self._owned)
            with suppress(*self._errors):  # at once, and not when the server has noticed the end
                self._run(self._owner, "SELECT pg_advisory_unlock_all()")
            self._drop(self._owner)
            self._owner = None

    def _own(self) -> None:
        if self._owner is not None and self._owned in OWNED:
            with suppress(*self._errors):
                self._run(self._owner, "SELECT 1")
                return
        self._disown()  # it ended with its connection, and somebody else may have it
        connection = self._connect()
        key = f"{_OWNING}, hashtext(current_schema())"
        try:
            [[is_owner]] = self._run(connection, f"SELECT pg_try_advisory_lock({key})")
            if not is_owner:
                raise owned_error(self.place, self._owner_name(connection))
        except BaseException:
            self._drop(connection)
            raise
        self._owner, self._owned = connection, connection.fileno()
        OWNED.add(self._owned)

    def _owner_name(self, connection: Any) -> str:
        query = (
            "SELECT a.application_name FROM pg_locks l JOIN pg_stat_activity a USING (pid)"
            f" WHERE l.locktype = 'advisory' AND l.granted AND l.database = a.datid AND l.classid = {_OWNING}"
            " AND l.objid::bigint = hashtext(current_schema())::bigint & 4294967295"
        )
        names = [name for [name] in self._run(connection, query) if name]
        return names[0].removeprefix(_NAME) if names else "another process"

    def _connect(self) -> Any:
        connection = self._psycopg.connect(autocommit=True, **self._parameters)
        try:
            connection.execute(self._settings)
        except BaseException:
            connection.close()
            raise
        return connection

    def _run(self, connection: Any, sql: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
        cursor = connection.execute(_placeholders(sql), values or None)
        rows: list[tuple[Any, ...]] = cursor.fetchall() if cursor.description else []
        return rows

    def _is_lost(self, connection: Any) -> bool:
        return bool(connection.closed)

    def _is_free(self, connection: Any) -> bool:
        return bool(connection.info.transaction_status == self._psycopg.pq.TransactionStatus.IDLE)

    def _reason(self, error: Exception) -> str:
        code = getattr(error, "sqlstate", None) or ""
        for beginning, reason in _REASONS.items():
            if code.startswith(beginning):
                return reason
        line = str(error).strip().partition("\n")[0]
        if isinstance(error, self._psycopg.OperationalError) and not code:
            return f"there's no connection: {line.rpartition(' failed: ')[2].removeprefix('FATAL:').strip()}"
        return line


def _defaults() -> dict[str, Any]:
    """Return the settings for what a URL leaves open."""
    return {
        "application_name": f"{_NAME}process {os.getpid()} on {socket.gethostname()}",
        "client_encoding": "utf8",
        "connect_timeout": max(int(PATIENCE), 2),  # the least that libpq takes
        "tcp_user_timeout": int(PATIENCE * 1000),
        "keepalives_idle": _SILENT // 3,
        "keepalives_interval": _SILENT // 6,
        "keepalives_count": 4,
    }


def _settings(durable: bool) -> str:
    """Return the settings that a connection begins with.

    The server, too, has to notice that the other end is gone. Where an index has the order that is asked for, it's
    never slow; sorting all tasks to get one is, which a new table looks small enough for.
    """
    return f"""
        SET synchronous_commit = {"on" if durable else "off"};
        SET lock_timeout = '{int(PATIENCE * 1000)}ms';
        SET idle_in_transaction_session_timeout = '{_SILENT}s';
        SET tcp_keepalives_idle = {_SILENT // 3};
        SET tcp_keepalives_interval = {_SILENT // 6};
        SET tcp_keepalives_count = 4;
        SET enable_sort = off
    """


@cache
def _placeholders(sql: str) -> str:
    return sql.replace("?", "%s")


def _without_secrets(place: str) -> str:
    try:
        parts = urlsplit(place)
        port = f":{parts.port}" if parts.port else ""
        user = f"{parts.username}@" if parts.username else ""
        return f"{parts.scheme}://{user}{parts.hostname or ''}{port}{parts.path}"
    except ValueError:
        return f"{place.partition(':')[0]}://..."

"""The tables of a store, as the steps from each version to the next one."""

from __future__ import annotations

import sqlite3

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.task.store.database import Database, Mode, store_error
from btlang.task.store.sqlite import Sqlite, columns
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from btlang.task.store.database import Execute

    Step = tuple[str, ...]

MIGRATIONS: list[Step] = [
    (
        "CREATE TABLE version (number BIGINT NOT NULL)",
        "INSERT INTO version (number) VALUES (0)",
        "CREATE TABLE counter (name TEXT PRIMARY KEY, value BIGINT NOT NULL)",
        "INSERT INTO counter (name, value) VALUES ('task', 0), ('change', 0), ('schedule', 0), ('act', 0)",
        """CREATE TABLE task (
            id BIGINT PRIMARY KEY, mission TEXT NOT NULL, person TEXT NOT NULL, created DOUBLE PRECISION NOT NULL,
            state TEXT NOT NULL, priority BIGINT NOT NULL, labels TEXT NOT NULL, earliest DOUBLE PRECISION,
            deadline DOUBLE PRECISION, restart TEXT NOT NULL, needs TEXT NOT NULL, schedule BIGINT NOT NULL,
            due DOUBLE PRECISION, position BIGINT NOT NULL, attempts BIGINT NOT NULL, started DOUBLE PRECISION,
            ended DOUBLE PRECISION, reason TEXT NOT NULL, saved TEXT NOT NULL, token TEXT NOT NULL,
            recording TEXT NOT NULL
        )""",
        """CREATE INDEX task_turn ON task (priority DESC, position, id)
            WHERE state NOT IN ('canceled', 'completed', 'error', 'failed', 'killed', 'skipped')""",
        """CREATE TABLE change (
            number BIGINT PRIMARY KEY, task BIGINT NOT NULL, time DOUBLE PRECISION NOT NULL, state TEXT NOT NULL,
            cause TEXT NOT NULL, person TEXT NOT NULL
        )""",
        "CREATE INDEX change_task ON change (task, number)",
        """CREATE TABLE schedule (
            id BIGINT PRIMARY KEY, rule TEXT NOT NULL, zone TEXT NOT NULL, mission TEXT NOT NULL, person TEXT NOT NULL,
            created DOUBLE PRECISION NOT NULL, next DOUBLE PRECISION, priority BIGINT NOT NULL, labels TEXT NOT NULL,
            restart TEXT NOT NULL, overlap TEXT NOT NULL, missed TEXT NOT NULL, within DOUBLE PRECISION
        )""",
        """CREATE TABLE revision (
            name TEXT NOT NULL, number BIGINT NOT NULL, text TEXT NOT NULL, person TEXT NOT NULL,
            time DOUBLE PRECISION NOT NULL, deleted BIGINT NOT NULL, PRIMARY KEY (name, number)
        )""",
        """CREATE TABLE act (
            number BIGINT PRIMARY KEY, time DOUBLE PRECISION NOT NULL, person TEXT NOT NULL, command TEXT NOT NULL,
            details TEXT NOT NULL, outcome TEXT NOT NULL
        )""",
        "CREATE TABLE setting (name TEXT PRIMARY KEY, value TEXT NOT NULL)",
    ),
    (
        """CREATE TABLE revision_of_kind (
            kind TEXT NOT NULL, name TEXT NOT NULL, number BIGINT NOT NULL, text TEXT NOT NULL, person TEXT NOT NULL,
            time DOUBLE PRECISION NOT NULL, deleted BIGINT NOT NULL, PRIMARY KEY (kind, name, number)
        )""",
        "INSERT INTO revision_of_kind SELECT 'mission', name, number, text, person, time, deleted FROM revision",
        "DROP TABLE revision",
        "ALTER TABLE revision_of_kind RENAME TO revision",
    ),
    (
        "ALTER TABLE task ADD COLUMN bonus BIGINT NOT NULL DEFAULT 0",
        "DROP INDEX task_turn",
        """CREATE INDEX task_turn ON task ((priority + bonus) DESC, position, id)
            WHERE state NOT IN ('canceled', 'completed', 'error', 'failed', 'killed', 'skipped')""",
    ),
]
"""The steps from version 0, an empty database, to 1, from there to 2, and so on.

A step that was released is never changed. The statements are for SQLite and PostgreSQL both; the first three columns of
a table have its key.
"""


def open_database(place: str, durable: bool) -> Database:
    """Return the database of a store, with all its tables. Raises MissionError as `open_store` does."""
    database = _database(place, durable)
    try:
        database.check()
        migrate(database)
    except BaseException:
        database.close()
        raise
    return database


def _database(place: str, durable: bool) -> Database:
    scheme, separator, _ = place.partition("://")
    if not separator:
        if "\0" in place:
            raise store_error(place, "this can't be the name of a file")
        return Sqlite(place, durable)
    from btlang.task.store.postgres import SCHEMES, Postgres

    if scheme not in SCHEMES:
        raise store_error(f"{scheme}://...", "it must be a file or a postgresql:// URL")
    return Postgres(place, durable)


def migrate(database: Database, steps: Sequence[Step] | None = None) -> None:
    """Bring a store to the version of this btlang, in one transaction: with these steps, by default those of tasks.

    Raises MissionError, and changes nothing: BT195 if it isn't a store of btlang, BT196 if its version is newer.
    """
    steps = MIGRATIONS if steps is None else steps
    with database.transaction(Mode.READ) as execute:
        version = stored_version(database, execute, steps)
    database.prepare()
    if version == len(steps):
        return
    with database.transaction(Mode.ALONE) as execute:
        for step in steps[stored_version(database, execute, steps) :]:  # another process may have been here before
            for statement in step:
                execute(statement)
        execute("UPDATE version SET number = ?", (len(steps),))


def stored_version(database: Database, execute: Execute, steps: Sequence[Step] | None = None) -> int:
    """Return the version of a store that may be used, 0 if there is none yet. Raises MissionError (BT195, BT196)."""
    steps = MIGRATIONS if steps is None else steps
    found = database.tables(execute)
    if "version" not in found:
        if found and (not database.is_shared or found.keys() & tables_of(steps).keys()):
            raise store_error(database.place, "it has tables, but it isn't a store of btlang")
        return 0
    rows = execute("SELECT number FROM version") if found["version"] == ["number"] else []
    if len(rows) != 1 or not isinstance(rows[0][0], int) or rows[0][0] < 1:
        raise store_error(database.place, "its version can't be read; perhaps it isn't a store of btlang")
    version = rows[0][0]
    if not found.keys() & tables_of(steps).keys() - {"version"}:
        raise store_error(database.place, "it has other tables than it should; perhaps it's a copy of something else")
    if version > len(steps):
        known = str(len(steps))
        raise MissionError([diagnostic("BT196", NOWHERE, place=database.place, version=str(version), known=known)])
    for table, expected in tables_of(steps[:version]).items():
        if sorted(found.get(table, ())) != sorted(expected):
            problem = "has other columns than it should" if table in found else "is missing"
            raise store_error(database.place, f"its table '{table}' {problem}")
    return version


def tables_of(steps: Sequence[Step]) -> dict[str, list[str]]:
    """Return the columns of each table that these steps make."""
    connection = sqlite3.connect(":memory:")
    try:
        for step in steps:
            for statement in step:
                connection.execute(statement)

        def execute(sql: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
            return connection.execute(sql, values).fetchall()

        return columns(execute)
    finally:
        connection.close()

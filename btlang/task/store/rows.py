"""The records of tasks as rows of tables and back, and the queries about tasks."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from enum import StrEnum
from functools import cache

from btlang.support.record import Record
from btlang.task.store.records import (
    FINAL,
    WAITING,
    LibraryKind,
    Missed,
    MissionText,
    Overlap,
    Restart,
    Task,
    TaskState,
)
from btlang.text.json_text import dump_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from btlang.task.store.database import Execute

    R = TypeVar("R", bound=Record)


_READERS: dict[str, Callable[[Any], Any]] = {
    "MissionText": lambda text: _mission(**json.loads(text)),
    "tuple[str, ...]": lambda text: tuple(json.loads(text)),
    "bool": bool,
    "float": float,
    "float | None": lambda number: None if number is None else float(number),  # RETURNING may give a whole number
    **{kind.__name__: kind for kind in (TaskState, Restart, Overlap, Missed, LibraryKind)},
}
"""The readers of values by the annotation of the field. Other values are as in the table."""


def columns_of(kind: type[Record]) -> str:
    """Return the columns of a record's table."""
    return ", ".join(kind.fields)


def marks(count: int) -> str:
    """Return as many placeholders of SQL."""
    return ", ".join("?" * count)


def to_row(record: Record) -> list[Any]:
    """Return the values of a record's columns."""
    return [to_column(getattr(record, field)) for field in record.fields]


def to_column(value: Any) -> Any:
    """Return the value of a field, for the table."""
    if isinstance(value, MissionText):
        return dump_json({**value.as_dict(), "values": dict(value.values)})
    if isinstance(value, tuple):
        return json.dumps(value, indent=0)  # in lines, so that `in_lines` finds one of them
    if isinstance(value, StrEnum):
        return value.value
    return int(value) if isinstance(value, bool) else value


def in_lines(text: str) -> str:
    """Return what a column for several texts contains if, and only if, this text is one of them."""
    return "\n" + json.dumps(text)


def insert(execute: Execute, table: str, record: Record, **more: object) -> None:
    """Add the row of a record, with further columns before it."""
    values = [*more.values(), *to_row(record)]
    execute(f"INSERT INTO {table} ({', '.join([*more, *record.fields])}) VALUES ({marks(len(values))})", values)


def from_row(kind: type[R], row: tuple[Any, ...]) -> R:
    """Return the record of a row. Raises ValueError or TypeError if it can't be one."""
    pairs = zip(row, _readers(kind), strict=True)
    return kind(*(value if reader is None else reader(value) for value, reader in pairs))


def _mission(keywords: list[str] | tuple[()] = (), **fields: Any) -> MissionText:
    return MissionText(keywords=tuple(keywords), **fields)


@cache
def _readers(kind: type[Record]) -> list[Callable[[Any], Any] | None]:
    return [_READERS.get(kind.__annotations__[field]) for field in kind.fields]


TASK = columns_of(Task)
IN_TURN = "(priority + bonus) DESC, position, id"
NOT_OVER = "state NOT IN ({})".format(", ".join(f"'{state}'" for state in sorted(FINAL)))
"""The condition of the index `task_turn`, word by word: only then SQLite uses it. Few tasks of a store are not over."""
NEXT = (
    f"SELECT {TASK} FROM task WHERE {NOT_OVER} AND (state = '{TaskState.QUEUED}' OR state = '{TaskState.DELAYED}'"
    f" AND token = '') AND (earliest IS NULL OR earliest <= ?)"
    f" AND (deadline IS NULL OR deadline >= ? OR started IS NOT NULL) ORDER BY {IN_TURN} LIMIT 1"
)
WAITS = "{} AND state IN ({})".format(NOT_OVER, ", ".join(f"'{state}'" for state in sorted(WAITING)))
AHEAD = f"(priority + bonus) = ? AND {NOT_OVER} AND id <> ? AND (position < ? OR (position = ? AND id < ?))"
"""The tasks before another one of the same priority, but for a third; also one under way, which may be interrupted."""
_QUEUED = f"{NOT_OVER} AND state = '{TaskState.QUEUED}'"
SINCE = "CASE WHEN earliest > created THEN earliest ELSE created END"
"""The time since when a task waits."""
UNBEGUN = f"{_QUEUED} AND started IS NULL"
"""A task that began in time may go on, or begin again, after its deadline."""
TIMES = (
    "SELECT min(time) FROM (SELECT next AS time FROM schedule WHERE next > ?"
    f" UNION ALL SELECT earliest FROM task WHERE {_QUEUED} AND earliest > ?"
    f" UNION ALL SELECT deadline FROM task WHERE {UNBEGUN} AND deadline > ?) AS times"
)


def task_condition(states: Collection[TaskState] | None, label: str, schedule: int) -> tuple[str, list[object]]:
    """Return the condition for tasks in some states, with a label, of a schedule (None, "" and 0: any), and its
    values.
    """
    conditions, values = ["1 = 1"], list[object]()
    if states is not None:
        names = [to_column(state) for state in states] or [""]  # there is no empty list in SQL
        conditions.append(f"state IN ({marks(len(names))})")
        values += names
        if not FINAL.intersection(states):
            conditions.append(NOT_OVER)
    if label:
        conditions.append("replace(labels, ?, '') <> labels")
        values.append(in_lines(label))
    if schedule:
        conditions.append("schedule = ?")
        values.append(schedule)
    return " AND ".join(conditions), values

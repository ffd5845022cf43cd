"""What the store asks of its table of tasks, in SQL that both databases understand."""

from __future__ import annotations

from collections.abc import Collection

from btlang.task.rows import columns_of, in_lines, marks, to_column
from btlang.task.task import FINAL, WAITING, State, Task

TASK = columns_of(Task)
IN_TURN = "(priority + bonus) DESC, position, id"
NOT_OVER = "state NOT IN ({})".format(", ".join(f"'{state}'" for state in sorted(FINAL)))
"""Word by word the condition of the index `task_turn`: only then SQLite uses it. Few tasks of a store are not over."""
NEXT = (
    f"SELECT {TASK} FROM task WHERE {NOT_OVER} AND (state = '{State.QUEUED}' OR state = '{State.DELAYED}'"
    f" AND token = '') AND (earliest IS NULL OR earliest <= ?)"
    f" AND (deadline IS NULL OR deadline >= ? OR started IS NOT NULL) ORDER BY {IN_TURN} LIMIT 1"
)
WAITS = "{} AND state IN ({})".format(NOT_OVER, ", ".join(f"'{state}'" for state in sorted(WAITING)))
AHEAD = f"(priority + bonus) = ? AND {WAITS} AND id <> ? AND (position < ? OR (position = ? AND id < ?))"
"""The tasks before another one of the same priority, but for a third."""
_QUEUED = f"{NOT_OVER} AND state = '{State.QUEUED}'"
SINCE = "CASE WHEN earliest > created THEN earliest ELSE created END"
"""Since when a task waits."""
UNBEGUN = f"{_QUEUED} AND started IS NULL"
"""A task that began in time may go on, or begin again, after its deadline."""
TIMES = (
    "SELECT min(time) FROM (SELECT next AS time FROM schedule WHERE next > ?"
    f" UNION ALL SELECT earliest FROM task WHERE {_QUEUED} AND earliest > ?"
    f" UNION ALL SELECT deadline FROM task WHERE {UNBEGUN} AND deadline > ?) AS times"
)


def chosen(states: Collection[State] | None, label: str, schedule: int) -> tuple[str, list[object]]:
    """The condition for tasks in some states, with a label, of a schedule (None, "" and 0: any), and its values."""
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

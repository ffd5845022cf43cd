"""What the task layer remembers: tasks and their changes, schedules, the library, the audit trail."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

from btlang.support.record import Record
from btlang.task.store.backup import write_backup
from btlang.task.store.database import Database, Mode, store_error
from btlang.task.store.migrations import open_database
from btlang.task.store.records import FINAL, Act, LibraryKind, Revision, Schedule, Task, TaskChange, TaskState
from btlang.task.store.rows import (
    AHEAD,
    IN_TURN,
    NEXT,
    NOT_OVER,
    SINCE,
    TASK,
    TIMES,
    UNBEGUN,
    WAITS,
    columns_of,
    from_row,
    insert,
    marks,
    task_condition,
    to_column,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any, TypeVar

    from btlang.task.store.database import Execute

    R = TypeVar("R", bound=Record)

_SCHEDULE, _REVISION, _ACT = (columns_of(kind) for kind in (Schedule, Revision, Act))


class TaskStore:
    """A store of tasks, to be used from any thread, and by several processes at once. Made by `open_store`.

    Each method is one transaction. Times are seconds since 1970 and come from the caller. Any method may raise
    StoreError (BT195), which says why the database refuses; then the store is unchanged.
    """

    def __init__(self, database: Database) -> None:
        self._database = database
        self._is_owner = False
        self.listeners: list[Callable[[], object]] = []
        """The functions to call after a change of a task by this process, in the thread that made it: they must be
        fast.
        """

    @property
    def place(self) -> str:
        """The place of the store, to be shown: without a password."""
        return self._database.place

    def __enter__(self) -> TaskStore:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End its connections and its ownership. May be called twice; other methods raise StoreError afterwards."""
        self._database.close()

    def own(self) -> None:
        """Make this process the one whose executor runs the tasks, until `close` or its end, or make sure of that.

        Raises MissionError (BT197) if another one is. From then on `claim` makes sure of it, too: with PostgreSQL an
        ownership ends with its connection.
        """
        self._database.own()
        self._is_owner = True

    def add(self, task: Task, cause: str = "") -> Task:
        """Keep a new task, with an id that no task of this store had before."""
        with self._database.transaction() as execute:
            added: Task = task.replace(id=_count(execute, "task"))
            insert(execute, "task", added)
            _note(execute, TaskChange(added.id, added.created, added.state, cause, added.person))
        self._notify()
        return added

    def task(self, id: int) -> Task | None:
        """Return a task; None if there's no such task, perhaps not any more."""
        return self._one(Task, f"SELECT {TASK} FROM task WHERE id = ?", id)

    def tasks(
        self,
        states: Collection[TaskState] | None = None,
        *,
        label: str = "",
        schedule: int = 0,
        newest: bool = False,
        limit: int | None = None,
    ) -> list[Task]:
        """Return the tasks in these states, with this label, of this schedule; in the order of their turn, or the
        newest first.
        """
        where, values = task_condition(states, label, schedule)
        order = "id DESC" if newest else IN_TURN
        query = f"SELECT {TASK} FROM task WHERE {where} ORDER BY {order}"
        return self._all(Task, query + _limit(limit, values), *values)

    def count_tasks(self, states: Collection[TaskState] | None = None, *, label: str = "", schedule: int = 0) -> int:
        """Return how many `tasks` gives without a limit."""
        where, values = task_condition(states, label, schedule)
        with self._database.transaction(Mode.READ) as execute:
            [[count]] = execute(f"SELECT count(*) FROM task WHERE {where}", values)
        return int(count)

    def change(
        self,
        id: int,
        before: Collection[TaskState],
        state: TaskState,
        *,
        time: float,
        cause: str = "",
        person: str = "",
        **fields: Any,
    ) -> Task | None:
        """Bring a task from one of the states `before` into another; set its reason to the cause, and `fields` by name.

        None, and no change, if it isn't in one of those states; a final state it never leaves.
        """
        with self._database.transaction() as execute:
            noted = TaskChange(id, time, state, cause, person)
            changed = self._notify_change(execute, noted, before, {"reason": cause, **fields})
        if changed is not None:
            self._notify()
        return changed

    def amend(self, id: int, **fields: Any) -> Task | None:
        """Set fields of a task without a change of its state. None if there's no such task."""
        _check(Task, fields, "state")
        with self._database.transaction() as execute:
            return self._update(execute, Task, "task", fields, "id = ?", id)

    def move_before(self, id: int, other: int) -> Task | None:
        """Give a task that waits its turn right before another one, with its priority. None if one of them is gone."""
        with self._database.transaction(Mode.ALONE) as execute:
            found = self._records(Task, execute(f"SELECT {TASK} FROM task WHERE id = ?", (other,)))
            if not found:
                return None
            [after] = found
            values = (after.priority + after.bonus, id, after.position, after.position, other)
            execute(f"UPDATE task SET position = position - 2 WHERE {AHEAD}", values)
            fields = {"priority": after.priority, "bonus": after.bonus, "position": after.position - 1}
            return self._update(execute, Task, "task", fields, "id = ?", id)

    def age(self, now: float, interval: float, most: int) -> None:
        """Give tasks that wait a bonus: 1 for each `interval` that they have waited, up to the `most`."""
        earned = " + ".join(f"CASE WHEN ({SINCE}) <= ? THEN 1 ELSE 0 END" for _ in range(most))
        since = [now - number * interval for number in range(1, most + 1)]
        with self._database.transaction() as execute:
            execute(f"UPDATE task SET bonus = {earned} WHERE {WAITS} AND bonus < ({earned})", (*since, *since))

    def claim(self, now: float) -> Task | None:
        """Return the task whose turn it is, on standby from now on; None if none may begin.

        No two callers get the same one.

        Raises MissionError (BT197) if this process was the owner and another one is now.
        """
        if self._is_owner:
            self._database.own()
        claimed = self._claim(now, Mode.WRITE)
        if claimed is None and self.peek(now) is not None:
            # somebody else had it at that moment; one at a time waits, since a lock on a row stays also where the row
            # has gone to another one meanwhile, and two who wait would wait for each other
            claimed = self._claim(now, Mode.ALONE)
        if claimed is not None:
            self._notify()
        return claimed

    def peek(self, now: float) -> Task | None:
        """Return the task that `claim` would give."""
        return self._one(Task, NEXT, now, now)

    def overdue(self, now: float) -> list[Task]:
        """Return the queued tasks that should have begun by a time that has passed, in the order of their turn."""
        query = f"SELECT {TASK} FROM task WHERE {UNBEGUN} AND deadline < ? ORDER BY {IN_TURN}"
        return self._all(Task, query, now)

    def next_time(self, now: float) -> float | None:
        """Return the first time after this one at which a task may begin, or no longer, or a schedule is due; None if
        none.
        """
        with self._database.transaction(Mode.READ) as execute:
            [[time]] = execute(TIMES, (now, now, now))
        return None if time is None else float(time)

    def changes(
        self, task: int | None = None, after: int = 0, limit: int | None = None
    ) -> list[tuple[int, TaskChange]]:
        """Return the changes of all tasks or of one, the oldest first, each with its number: those with a higher one
        than `after`. Numbers ascend in the order in which changes can be seen, so nobody who reads on misses one.
        """
        values: list[object] = [after]
        of = ""
        if task is not None:
            of = " AND task = ?"
            values.append(task)
        query = f"SELECT {columns_of(TaskChange)}, number FROM change WHERE number > ?{of} ORDER BY number"
        with self._database.transaction(Mode.READ) as execute:
            rows = execute(query + _limit(limit, values), values)
        found = self._records(TaskChange, [row[:-1] for row in rows])
        return [(row[-1], change) for row, change in zip(rows, found, strict=True)]

    def latest_change(self) -> int:
        """Return the number of the last change, also if it was deleted since; 0 if there was none."""
        with self._database.transaction(Mode.READ) as execute:
            [[number]] = execute("SELECT value FROM counter WHERE name = 'change'")
        return int(number)

    def add_schedule(self, schedule: Schedule) -> Schedule:
        """Keep a new schedule, with an id that no schedule of this store had before."""
        with self._database.transaction() as execute:
            added: Schedule = schedule.replace(id=_count(execute, "schedule"))
            insert(execute, "schedule", added)
        return added

    def schedule(self, id: int) -> Schedule | None:
        """Return a schedule; None if there's no such schedule."""
        return self._one(Schedule, f"SELECT {_SCHEDULE} FROM schedule WHERE id = ?", id)

    def schedules(self) -> list[Schedule]:
        """Return all schedules, the oldest first."""
        return self._all(Schedule, f"SELECT {_SCHEDULE} FROM schedule ORDER BY id")

    def due_schedules(self, now: float) -> list[Schedule]:
        """Return the schedules whose time has come, the one that is due longest first."""
        return self._all(Schedule, f"SELECT {_SCHEDULE} FROM schedule WHERE next <= ? ORDER BY next, id", now)

    def amend_schedule(self, id: int, **fields: Any) -> Schedule | None:
        """Set fields of a schedule. None if there's no such schedule."""
        _check(Schedule, fields)
        with self._database.transaction() as execute:
            return self._update(execute, Schedule, "schedule", fields, "id = ?", id)

    def delete_schedule(self, id: int) -> bool:
        """Delete a schedule; return whether there was one. Its tasks stay."""
        with self._database.transaction() as execute:
            return bool(execute("DELETE FROM schedule WHERE id = ? RETURNING id", (id,)))

    def put_text(
        self,
        name: str,
        text: str,
        person: str,
        time: float,
        base: int | None = None,
        kind: LibraryKind = LibraryKind.MISSION,
    ) -> Revision | None:
        """Return the revision that has this text: the latest one of that name, or else a new one.

        None, and no change, if it was made from another one, `base`, than the latest, 0 if there is none.
        """
        with self._database.transaction(Mode.ALONE) as execute:
            latest = self._latest(execute, name, kind)
            if base not in (None, 0 if latest is None or latest.deleted else latest.number):
                return None
            if latest is not None and not latest.deleted and latest.text == text:
                return latest
            put = Revision(name, latest.number + 1 if latest else 1, text, person, time, kind=kind)
            insert(execute, "revision", put)
        return put

    def text(self, name: str, number: int = 0, kind: LibraryKind = LibraryKind.MISSION) -> Revision | None:
        """Return a revision, 0 for the latest. None if there isn't one, or the text is deleted by it."""
        which = "kind = ? AND name = ? AND (number = ? OR ? = 0) ORDER BY number DESC LIMIT 1"
        query = f"SELECT {_REVISION} FROM revision WHERE {which}"
        found = self._one(Revision, query, kind.value, name, number, number)
        return None if found is None or found.deleted else found

    def texts(self, kind: LibraryKind = LibraryKind.MISSION) -> list[Revision]:
        """Return the latest revision of each text that isn't deleted, by name."""
        latest = (
            "SELECT max(number) FROM revision other WHERE other.kind = revision.kind AND other.name = revision.name"
        )
        which = f"kind = ? AND deleted = 0 AND number = ({latest})"
        found = self._all(Revision, f"SELECT {_REVISION} FROM revision WHERE {which}", kind.value)
        return sorted(found, key=lambda revision: revision.name)  # the same order in all databases

    def revisions(self, name: str, kind: LibraryKind = LibraryKind.MISSION) -> list[Revision]:
        """Return all revisions of a text, the oldest first, with those that deleted it."""
        query = f"SELECT {_REVISION} FROM revision WHERE kind = ? AND name = ? ORDER BY number"
        return self._all(Revision, query, kind.value, name)

    def delete_text(self, name: str, person: str, time: float, kind: LibraryKind = LibraryKind.MISSION) -> bool:
        """Delete a text; return whether there was one. Its revisions stay, and one more says who deleted it."""
        with self._database.transaction(Mode.ALONE) as execute:
            latest = self._latest(execute, name, kind)
            if latest is None or latest.deleted:
                return False
            insert(execute, "revision", Revision(name, latest.number + 1, "", person, time, deleted=True, kind=kind))
        return True

    def log(self, act: Act) -> None:
        """Add to the audit trail."""
        with self._database.transaction() as execute:
            insert(execute, "act", act, number=_count(execute, "act"))

    def acts(self, limit: int | None = None) -> list[Act]:
        """Return the audit trail, the newest first."""
        values: list[object] = []
        return self._all(Act, f"SELECT {_ACT} FROM act ORDER BY number DESC" + _limit(limit, values), *values)

    def setting(self, name: str) -> str:
        """Return what was set last, "" if nothing was."""
        with self._database.transaction(Mode.READ) as execute:
            rows = execute("SELECT value FROM setting WHERE name = ?", (name,))
        return str(rows[0][0]) if rows else ""

    def set_setting(self, name: str, value: str) -> None:
        """Keep a text under a name."""
        keep = "INSERT INTO setting (name, value) VALUES (?, ?) ON CONFLICT (name) DO UPDATE SET value = excluded.value"
        with self._database.transaction() as execute:
            execute(keep, (name, value))

    def clean(self, before: float) -> int:
        """Delete the tasks that ended before a time, with their changes, and the audit trail before it.

        Tasks that are not over stay, and the library does. Returns how many tasks were deleted.
        """
        ended = "coalesce(ended, (SELECT max(time) FROM change WHERE change.task = task.id), created)"
        over = f"DELETE FROM task WHERE NOT ({NOT_OVER}) AND {ended} < ? RETURNING id"
        with self._database.transaction(Mode.ALONE) as execute:
            deleted = execute(over, (before,))
            execute("DELETE FROM change WHERE NOT EXISTS (SELECT 1 FROM task WHERE task.id = change.task)")
            execute("DELETE FROM act WHERE time < ?", (before,))
        return len(deleted)

    def backup(self, path: str) -> None:
        """Write all into a new SQLite file, as it is at one moment; others may use the store meanwhile.

        The file is there only once it's complete. Raises StoreError, also if there is such a file already.
        """
        write_backup(self._database, path)

    def _notify(self) -> None:
        for listener in tuple(self.listeners):
            listener()

    def _claim(self, now: float, mode: Mode) -> Task | None:
        with self._database.transaction(mode) as execute:
            found = self._records(Task, execute(NEXT + self._database.row_lock[mode], (now, now)))
            if not found:
                return None
            [task] = found
            noted = TaskChange(task.id, now, TaskState.STANDBY, "its turn", "")
            fields = {"reason": noted.cause, "attempts": task.attempts + 1}
            return self._notify_change(execute, noted, (task.state,), fields)

    def _latest(self, execute: Execute, name: str, kind: LibraryKind) -> Revision | None:
        query = f"SELECT {_REVISION} FROM revision WHERE kind = ? AND name = ? ORDER BY number DESC LIMIT 1"
        found = self._records(Revision, execute(query, (kind.value, name)))
        return found[0] if found else None

    def _notify_change(
        self, execute: Execute, noted: TaskChange, before: Collection[TaskState], fields: Mapping[str, Any]
    ) -> Task | None:
        _check(Task, fields)
        states = [to_column(state) for state in before if state not in FINAL] or [""]
        condition = f"id = ? AND state IN ({marks(len(states))})"
        task = self._update(execute, Task, "task", {**fields, "state": noted.state}, condition, noted.task, *states)
        if task is not None:
            _note(execute, noted)
        return task

    def _update(
        self, execute: Execute, kind: type[R], table: str, fields: Mapping[str, Any], condition: str, *values: object
    ) -> R | None:
        assigned = ", ".join(f"{field} = ?" for field in fields) or "id = id"
        query = f"UPDATE {table} SET {assigned} WHERE {condition} RETURNING {columns_of(kind)}"
        found = self._records(kind, execute(query, (*map(to_column, fields.values()), *values)))
        return found[0] if found else None

    def _one(self, kind: type[R], query: str, *values: object) -> R | None:
        found = self._all(kind, query, *values)
        return found[0] if found else None

    def _all(self, kind: type[R], query: str, *values: object) -> list[R]:
        with self._database.transaction(Mode.READ) as execute:
            rows = execute(query, values)
        return self._records(kind, rows)

    def _records(self, kind: type[R], rows: list[tuple[Any, ...]]) -> list[R]:
        try:
            return [from_row(kind, row) for row in rows]
        except (ValueError, TypeError, RecursionError) as error:
            raise store_error(self.place, f"it's damaged: a {kind.__name__.lower()} can't be read") from error


def open_store(place: str, durable: bool = False) -> TaskStore:
    """Return the store at a place: a file, which is made if it doesn't exist, or a postgresql:// URL of a database.

    A file is read once from end to end, in a tenth of a second for 100,000 tasks, to see whether it's damaged.

    What a method has changed outlives the process, `kill -9` included; if `durable`, also a loss of power and a crash
    of the server. Raises MissionError: BT189 if the package for PostgreSQL is missing, BT195 if it isn't a store or
    can't be used, BT196 if it belongs to a newer btlang.
    """
    return TaskStore(open_database(place, durable))


def _count(execute: Execute, name: str) -> int:
    """Return the next number.

    Who has taken one makes others wait until the end of the transaction, so they end in order.
    """
    [[number]] = execute("UPDATE counter SET value = value + 1 WHERE name = ? RETURNING value", (name,))
    return int(number)


def _note(execute: Execute, change: TaskChange) -> None:
    insert(execute, "change", change, number=_count(execute, "change"))


def _check(kind: type[Record], fields: Mapping[str, Any], *fixed: str) -> None:
    for field in fields:
        if field not in kind.fields or field in ("id", *fixed):
            raise TypeError(f"'{field}' of a {kind.__name__} can't be set here")


def _limit(limit: int | None, values: list[object]) -> str:
    if limit is None:
        return ""
    values.append(min(max(limit, 0), 2**63 - 1))
    return " LIMIT ?"

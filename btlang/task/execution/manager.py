"""Decides which task comes next: queue, deadlines and schedules, on what the store keeps."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator

from btlang.engine.status import FAILURE
from btlang.task.schedule.calendar import format_moment
from btlang.task.schedule.recurrence import read_rule
from btlang.task.store.records import ACTIVE, WAITING, Missed, MissionText, Overlap, Restart, Schedule, Task, TaskState

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.task.store.task_store import TaskStore

_PUNCTUAL = 60.0  # seconds after its time from which one that was missed counts as missed
DAY = 86_400.0
_AGE, _MOST_BONUS = 600.0, 10  # seconds of waiting that count as one of priority, and how much they count at most
_MOST_LATE = 1000  # tasks that a schedule makes at most of the times that were missed
CUT_OFF = "the robot was cut off"
ENDED = "ended"
"""A key in place of a saved run: the status with which its tree ended."""


class TaskManager:
    """The queue of tasks: which is next.

    All times are in seconds since 1970. Methods raise StoreError where the store can't be used.

    A task is due if it is queued, or was suspended for a more urgent one, and its earliest time has come.
    """

    def __init__(
        self,
        store: TaskStore,
        keeps: float = math.inf,
        needs: Callable[[MissionText], tuple[str, ...]] = lambda mission: (),
    ) -> None:
        """Keep tasks that are over for `keeps` seconds; `needs` gives what a mission needs."""
        self._store, self._keeps, self._needs = store, keeps, needs
        self._tidied = -math.inf

    def recover(self, now: float, stopped: str = "") -> list[Task]:
        """Decide, after a start, what becomes of the task that was under way when the robot's process ended.

        `stopped` is why the robot was stopped: an emergency stop kills it also if the process ended before that was
        written down.
        """
        found = []
        for task in self._store.tasks(ACTIVE):
            if stopped and task.state is TaskState.UNDERWAY:
                after = self._store.change(task.id, ACTIVE, TaskState.KILLED, time=now, cause=stopped, ended=now)
            else:
                after = describe_recovery(task, self._store, now, CUT_OFF)
            if after is not None:
                found.append(after)
        return found

    def refresh(self, now: float) -> list[Task]:
        """Make the tasks whose scheduled times have come, and skip those whose deadline has passed.

        Returns tasks under way that their schedules replace.
        """
        replaced: list[Task] = []
        for schedule in self._store.due_schedules(now):
            replaced += self._come(schedule, now)
        for task in self._store.overdue(now):
            assert task.deadline is not None
            self._skip(
                task, now, f"it couldn't begin by {format_moment(task.deadline, now)}: {task.reason or 'no time'}"
            )
        return replaced

    def tidy(self, now: float) -> None:
        """Delete what is too old, once a day at most."""
        if self._keeps < math.inf and not self._tidied <= now < self._tidied + DAY:
            self._store.clean(now - self._keeps)
            self._tidied = now

    def claim(self, now: float) -> Task | None:
        """Return the next task, which is then the executor's. First it counts how long tasks have waited."""
        self._store.age(now, _AGE, _MOST_BONUS)
        return self._store.claim(now)

    def is_more_urgent(self, than: Task, now: float) -> bool:
        """Return whether a task is due that another one has to make way for."""
        best = self._store.peek(now)
        if best is None:
            return False
        known = self._store.task(than.id) or than  # it may have been moved since it began
        return best.priority > known.priority

    def next_time(self, now: float) -> float | None:
        """Return when to look again, if nobody asks for anything before."""
        return self._store.next_time(now)

    def first(self, now: float) -> int:
        """Return the task that is under way, or else the next one; 0 for none."""
        active = self._store.tasks(ACTIVE)
        best = active[0] if active else self._store.peek(now)
        return best.id if best is not None else 0

    def why_waiting(self, task: Task, now: float, hindrance: str = "", first: int | None = None) -> str:
        """Return why a task that waits hasn't begun yet. `first` is that of the method, if known."""
        if task.state not in WAITING:
            return ""
        if task.state is TaskState.DELAYED and task.token:
            return f"it was interrupted: {task.reason}" if task.reason else "it was interrupted"
        if task.state is TaskState.BLOCKED:
            return task.reason
        if task.earliest is not None and task.earliest > now:
            return f"its time is {format_moment(task.earliest, now)}"
        if hindrance:
            return hindrance
        first = self.first(now) if first is None else first
        return f"task {first} comes first" if first not in (0, task.id) else "it's next"

    def _come(self, schedule: Schedule, now: float) -> Iterator[Task]:
        assert schedule.next is not None
        recurrence = read_rule(schedule.rule, schedule.zone)
        times = [schedule.next]
        for time in recurrence.between(schedule.next, now):
            times.append(time)
            if len(times) > _MOST_LATE:
                break
        late: set[int] = set()  # tasks for times that were missed, which all are to be made up for
        for time in self._worth_doing(schedule, times, now):
            is_late = now - time > _PUNCTUAL
            yield from self._make(schedule, time, now, late if is_late else set())
        self._store.amend_schedule(schedule.id, next=recurrence.next(max(now, times[-1])))

    def _worth_doing(self, schedule: Schedule, times: list[float], now: float) -> Iterator[float]:
        """Yield the times of a schedule for which a task is made; the others get a task that is skipped, with the
        reason.
        """
        missed = [time for time in times if now - time > _PUNCTUAL]
        kept = {Missed.SKIP: [], Missed.ONCE: missed[-1:], Missed.ALL: missed}[schedule.missed]
        if len(missed) < len(times):
            kept = [] if schedule.missed is Missed.ONCE else kept
        for time in times:
            if time in missed and time not in kept:
                task = self._store.add(self._task(schedule, time, now), "its time has come")
                self._skip(
                    task, now, f"its time, {format_moment(time, now)}, was missed: the robot wasn't up, or was stopped"
                )
            else:
                yield time

    def _make(self, schedule: Schedule, time: float, now: float, late: set[int]) -> Iterator[Task]:
        """Make a task, which may overlap those in `late`; it is one of them from then on."""
        before = self._store.tasks(WAITING | ACTIVE, schedule=schedule.id)
        earlier = [task for task in before if task.id not in late]
        task = self._store.add(self._task(schedule, time, now), "its time has come")
        late.add(task.id)
        if not earlier:
            return
        if schedule.overlap is Overlap.SKIP:
            self._skip(task, now, f"task {earlier[0].id} of the same schedule isn't over")
        elif schedule.overlap is Overlap.REPLACE:
            for other in earlier:
                if other.state in WAITING:
                    self._skip(other, now, f"task {task.id} of the same schedule replaces it")
                else:
                    yield other

    def _skip(self, task: Task, now: float, reason: str) -> None:
        self._store.change(task.id, WAITING, TaskState.SKIPPED, time=now, cause=reason, ended=now)

    def _task(self, schedule: Schedule, time: float, now: float) -> Task:
        deadline = None if schedule.within is None else time + schedule.within
        return Task(
            0, schedule.mission, schedule.person, now, priority=schedule.priority, labels=schedule.labels,
            deadline=deadline, restart=schedule.restart, needs=self._needs(schedule.mission), schedule=schedule.id,
            due=time,
        )  # fmt: skip


def describe_recovery(task: Task, store: TaskStore, now: float, reason: str) -> Task | None:
    """Return a task that was under way and is no longer, as it says itself: given up, again from its start, or
    resumed.
    """
    if task.state is TaskState.STANDBY:
        return store.change(task.id, ACTIVE, TaskState.QUEUED, time=now, cause=f"{reason} before it began")
    if task.restart is Restart.GIVE_UP:
        return store.change(task.id, ACTIVE, TaskState.ERROR, time=now, cause=reason, ended=now)
    saved = task.saved if task.restart is Restart.RESUME else ""
    status = json.loads(saved).get(ENDED) if saved else None
    if status is not None:
        state = TaskState.FAILED if status is FAILURE else TaskState.COMPLETED
        return store.change(task.id, ACTIVE, state, time=now, cause=f"{reason} when it was over", ended=now)
    how = "goes on where it was" if saved else "begins again"
    return store.change(task.id, ACTIVE, TaskState.QUEUED, time=now, cause=f"{reason}; it {how}", saved=saved)

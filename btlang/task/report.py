"""What a robot did in some days, in English: every scheduled time with what became of it, and why if it wasn't done."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.task.answers import short
from btlang.task.moments import shown
from btlang.task.store import Store
from btlang.task.task import FINAL, Schedule, State, Task
from btlang.text.escaping import one_line


def report(store: Store, since: float, until: float) -> Iterator[str]:
    """Lines for people. What counts is when a task was due, or else when it was asked for: seconds since 1970."""
    tasks = [task for task in store.tasks() if since <= _time_of(task) < until]
    tasks.sort(key=lambda task: (_time_of(task), task.id))
    yield f"From {shown(since, 0.0)} to {shown(until, 0.0)}: {_counted(tasks)}."
    schedules = {schedule.id: schedule for schedule in store.schedules()}
    for number in sorted({task.schedule for task in tasks if task.schedule}):
        group = [task for task in tasks if task.schedule == number]
        yield from _group(_title(group[0], schedules.get(number)), group)
    for person in sorted({task.person for task in tasks if not task.schedule}):
        group = [task for task in tasks if not task.schedule and task.person == person]
        yield from _group(f"{one_line(person) or 'Somebody'} asked", group)


def _group(title: str, tasks: Sequence[Task]) -> Iterator[str]:
    yield ""
    yield f"{title}: {_counted(tasks)}."
    for task in tasks:
        if task.state is not State.COMPLETED:
            reason = f": {one_line(task.reason)}" if task.reason else ""
            yield f"  {shown(_time_of(task), 0.0)}  task {task.id}, {short(task.mission)}: {task.state}{reason}"


def _counted(tasks: Sequence[Task]) -> str:
    done = sum(task.state is State.COMPLETED for task in tasks)
    still_open = sum(task.state not in FINAL for task in tasks)
    rest = f", {still_open} not over yet" if still_open else ""
    return f"{done} of {len(tasks)} done{rest}"


def _title(task: Task, schedule: Schedule | None) -> str:
    rule = schedule.rule if schedule is not None else "a schedule that is removed"
    return f"{short(task.mission)} ({rule})"


def _time_of(task: Task) -> float:
    return task.created if task.due is None else task.due

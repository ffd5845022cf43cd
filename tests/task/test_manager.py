"""What comes next, by times that the test gives: schedules, deadlines, restarts."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from btlang.task.execution.manager import TaskManager
from btlang.task.schedule.recurrence import read_rule
from btlang.task.store.records import ACTIVE, Missed, MissionText, Overlap, Restart, Schedule, Task, TaskState
from btlang.task.store.task_store import TaskStore, open_store

DAY = 86_400.0
NINE = datetime(2026, 3, 2, 9, tzinfo=UTC).timestamp()
RULE = "every day at 9:00"


@pytest.fixture
def store(tmp_path: Path) -> Iterator[TaskStore]:
    with open_store(str(tmp_path / "tasks.db")) as opened:
        yield opened


def add_schedule(store: TaskStore, now: float = NINE - 3600, **fields: Any) -> Schedule:
    first = read_rule(RULE, "UTC").next(now)
    return store.add_schedule(Schedule(0, RULE, "UTC", MissionText("wave"), "ann", now, first, **fields))


def states(store: TaskStore) -> list[TaskState]:
    return [task.state for task in sorted(store.tasks(), key=lambda task: task.id)]


def reasons(store: TaskStore) -> list[str]:
    return [task.reason for task in sorted(store.tasks(), key=lambda task: task.id)]


def test_a_task_is_made_when_its_time_has_come(store: TaskStore) -> None:
    manager, schedule = TaskManager(store), add_schedule(store, priority=3, labels=("tour",), within=600.0)
    manager.refresh(NINE - 1)
    assert store.tasks() == []
    assert manager.next_time(NINE - 1) == NINE
    manager.refresh(NINE + 2)
    [task] = store.tasks()
    assert (task.due, task.priority, task.labels, task.deadline) == (NINE, 3, ("tour",), NINE + 600)
    assert task.schedule == schedule.id
    manager.refresh(NINE + 3)
    assert len(store.tasks()) == 1
    assert manager.next_time(NINE + 3) == NINE + 600
    manager.refresh(NINE + 601)
    assert states(store) == [TaskState.SKIPPED]
    assert reasons(store)[0].startswith("it couldn't begin by ")
    assert manager.next_time(NINE + 601) == NINE + DAY


def test_a_clock_that_is_set_back_brings_no_time_twice(store: TaskStore) -> None:
    manager = TaskManager(store)
    add_schedule(store)
    for now in (NINE + 1, NINE - 3600, NINE + 1, NINE + 5, NINE + DAY + 1):
        manager.refresh(now)
    assert [task.due for task in sorted(store.tasks(), key=lambda task: task.id)] == [NINE, NINE + DAY]


@pytest.mark.parametrize(
    ("overlap", "expected"),
    [
        (Overlap.SKIP, [TaskState.QUEUED, TaskState.SKIPPED]),
        (Overlap.QUEUE, [TaskState.QUEUED, TaskState.QUEUED]),
        (Overlap.REPLACE, [TaskState.SKIPPED, TaskState.QUEUED]),
    ],
)
def test_the_task_before_is_not_over(store: TaskStore, overlap: Overlap, expected: list[TaskState]) -> None:
    manager = TaskManager(store)
    add_schedule(store, overlap=overlap)
    manager.refresh(NINE)
    manager.refresh(NINE + DAY)
    assert states(store) == expected


def test_one_under_way_is_named_where_another_replaces_it(store: TaskStore) -> None:
    manager = TaskManager(store)
    add_schedule(store, overlap=Overlap.REPLACE)
    manager.refresh(NINE)
    claimed = manager.claim(NINE)
    assert claimed is not None
    assert [task.id for task in manager.refresh(NINE + DAY)] == [claimed.id]


@pytest.mark.parametrize(
    ("missed", "expected"),
    [
        (Missed.SKIP, [TaskState.SKIPPED] * 3),
        (Missed.ONCE, [TaskState.SKIPPED, TaskState.SKIPPED, TaskState.QUEUED]),
        (Missed.ALL, [TaskState.QUEUED] * 3),
    ],
)
def test_times_that_were_missed(store: TaskStore, missed: Missed, expected: list[TaskState]) -> None:
    manager = TaskManager(store)
    add_schedule(store, missed=missed, overlap=Overlap.QUEUE)
    manager.refresh(NINE + 2 * DAY + 3600)
    assert states(store) == expected
    assert all("was missed" in task.reason for task in store.tasks() if task.state is TaskState.SKIPPED)
    assert manager.next_time(NINE + 2 * DAY + 3600) == NINE + 3 * DAY


@pytest.mark.parametrize(
    ("restart", "saved", "state", "kept"),
    [
        (Restart.GIVE_UP, '{"now": 1}', TaskState.ERROR, '{"now": 1}'),
        (Restart.AGAIN, '{"now": 1}', TaskState.QUEUED, ""),
        (Restart.RESUME, '{"now": 1}', TaskState.QUEUED, '{"now": 1}'),
        (Restart.RESUME, '{"ended": true}', TaskState.COMPLETED, '{"ended": true}'),
        (Restart.RESUME, '{"ended": false}', TaskState.FAILED, '{"ended": false}'),
    ],
)
def test_what_was_under_way(store: TaskStore, restart: Restart, saved: str, state: TaskState, kept: str) -> None:
    manager = TaskManager(store)
    task = store.add(Task(0, MissionText("wave"), "ann", NINE, restart=restart))
    assert manager.claim(NINE) is not None
    store.change(task.id, {TaskState.STANDBY}, TaskState.UNDERWAY, time=NINE)
    store.amend(task.id, saved=saved)
    [after] = manager.recover(NINE + 60)
    assert (after.state, after.saved) == (state, kept)
    assert "the robot was cut off" in after.reason
    assert manager.recover(NINE + 61) == []


@pytest.mark.parametrize("restart", list(Restart))
def test_one_that_had_not_yet_begun_to_go_on_stays_in_the_queue(store: TaskStore, restart: Restart) -> None:
    manager = TaskManager(store)
    store.add(Task(0, MissionText("wave"), "ann", NINE, TaskState.DELAYED, restart=restart, saved='{"now": 1}'))
    assert manager.claim(NINE) is not None
    [after] = manager.recover(NINE + 60)
    assert (after.state, after.saved) == (TaskState.QUEUED, '{"now": 1}')


def test_a_task_under_way_counts_with_the_priority_that_it_has_now(store: TaskStore) -> None:
    manager = TaskManager(store)
    task = store.add(Task(0, MissionText("wave"), "ann", NINE, priority=2))
    claimed = manager.claim(NINE)
    assert claimed is not None
    store.add(Task(0, MissionText("wave"), "ann", NINE, priority=1))
    assert not manager.is_more_urgent(claimed, NINE)
    store.amend(task.id, priority=0)
    assert manager.is_more_urgent(claimed, NINE)


@pytest.mark.parametrize("state", [TaskState.QUEUED, TaskState.DELAYED])
def test_a_deadline_is_for_the_beginning_alone(store: TaskStore, state: TaskState) -> None:
    """Who was interrupted, or cut off, may go on after it."""
    manager = TaskManager(store)
    task = store.add(Task(0, MissionText("wave"), "ann", NINE, state, deadline=NINE + 60, started=NINE))
    assert manager.next_time(NINE) is None
    manager.refresh(NINE + 61)
    claimed = manager.claim(NINE + 61)
    assert (claimed and claimed.id) == task.id


def test_why_a_task_waits(store: TaskStore) -> None:
    manager = TaskManager(store)
    first = store.add(Task(0, MissionText("wave"), "ann", NINE))
    second = store.add(Task(0, MissionText("wave"), "ann", NINE))
    later = store.add(Task(0, MissionText("wave"), "ann", NINE, earliest=NINE + 60))
    assert manager.why_waiting(first, NINE) == "it's next"
    assert manager.why_waiting(second, NINE) == f"task {first.id} comes first"
    assert manager.why_waiting(later, NINE).startswith("its time is ")
    assert manager.why_waiting(first, NINE, "the robot is paused") == "the robot is paused"


@pytest.mark.parametrize(
    ("state", "fields", "why"),
    [
        (TaskState.COMPLETED, {"reason": "done"}, ""),
        (TaskState.BLOCKED, {"reason": "no hands", "earliest": NINE + 60}, "no hands"),
        (TaskState.DELAYED, {"token": "t", "reason": "by ann"}, "it was interrupted: by ann"),
        (TaskState.DELAYED, {"token": "t"}, "it was interrupted"),
        (TaskState.DELAYED, {"reason": "cut off"}, "the robot is paused"),
        (TaskState.QUEUED, {"token": "t", "reason": "resumed"}, "the robot is paused"),
        (TaskState.QUEUED, {"earliest": NINE}, "the robot is paused"),
    ],
)
def test_why_a_task_of_this_state_waits(store: TaskStore, state: TaskState, fields: dict[str, Any], why: str) -> None:
    task = store.add(Task(0, MissionText("wave"), "ann", NINE, state, **fields))
    assert TaskManager(store).why_waiting(task, NINE, "the robot is paused") == why


def test_which_task_is_first(store: TaskStore) -> None:
    manager = TaskManager(store)
    assert manager.first(NINE) == 0
    waiting = store.add(Task(0, MissionText("wave"), "ann", NINE))
    assert manager.why_waiting(waiting, NINE, first=0) == "it's next"
    assert manager.why_waiting(waiting, NINE, first=waiting.id + 7) == f"task {waiting.id + 7} comes first"
    claimed = manager.claim(NINE)
    urgent = store.add(Task(0, MissionText("wave"), "ann", NINE, priority=5))
    assert (claimed and claimed.id) == manager.first(NINE) == waiting.id
    assert manager.why_waiting(urgent, NINE) == f"task {waiting.id} comes first"


def test_nothing_is_more_urgent_than_an_equal(store: TaskStore) -> None:
    manager = TaskManager(store)
    store.add(Task(0, MissionText("wave"), "ann", NINE, priority=1))
    assert (claimed := manager.claim(NINE)) is not None
    assert manager.is_more_urgent(claimed, NINE) is False
    store.add(Task(0, MissionText("wave"), "ann", NINE, priority=1))
    assert manager.is_more_urgent(claimed, NINE) is False
    assert manager.is_more_urgent(claimed.replace(id=99, priority=0), NINE) is True


def test_what_is_put_before_another_one_comes_behind_what_was_interrupted(store: TaskStore) -> None:
    manager = TaskManager(store)
    first, second, third = (store.add(Task(0, MissionText("wave"), "ann", NINE)).id for _ in range(3))
    assert (claimed := manager.claim(NINE)) is not None
    assert claimed.id == first
    store.move_before(third, second)
    store.change(first, ACTIVE, TaskState.DELAYED, time=NINE, cause="a more urgent task comes first")
    assert [each.id for _ in range(3) if (each := manager.claim(NINE))] == [first, third, second]


def test_an_emergency_stop_kills_what_was_under_way_alone(store: TaskStore) -> None:
    manager = TaskManager(store)
    task = store.add(Task(0, MissionText("wave"), "ann", NINE))
    assert manager.claim(NINE) is not None
    [again] = manager.recover(NINE + 1, "the stop was pressed")
    assert again.state is TaskState.QUEUED  # it hadn't begun
    assert manager.claim(NINE + 2) is not None
    store.change(task.id, {TaskState.STANDBY}, TaskState.UNDERWAY, time=NINE)
    [killed] = manager.recover(NINE + 3, "the stop was pressed")
    assert (killed.state, killed.reason, killed.ended) == (TaskState.KILLED, "the stop was pressed", NINE + 3)


def test_why_a_task_could_not_begin(store: TaskStore) -> None:
    manager = TaskManager(store)
    for fields in ({}, {"state": TaskState.BLOCKED, "reason": "no hands"}):
        store.add(Task(0, MissionText("wave"), "ann", NINE, deadline=NINE + 60, **fields))  # type: ignore[arg-type]
    manager.refresh(NINE + 61)
    assert [reason.rpartition(": ")[2] for reason in reasons(store)] == ["no time", "no hands"]


@pytest.mark.parametrize(("seconds", "missed"), [(60.0, False), (60.1, True)])
def test_one_minute_late_is_in_time(store: TaskStore, seconds: float, missed: bool) -> None:
    add_schedule(store, missed=Missed.SKIP)
    TaskManager(store).refresh(NINE + seconds)
    assert states(store) == [TaskState.SKIPPED if missed else TaskState.QUEUED]


def test_one_that_is_late_overlaps_one_in_time(store: TaskStore) -> None:
    """What comes a minute late waits for the one before like what comes in time; what is made up for later doesn't."""
    manager = TaskManager(store)
    add_schedule(store, missed=Missed.ALL, overlap=Overlap.SKIP)
    manager.refresh(NINE + DAY + 60)
    assert states(store) == [TaskState.QUEUED, TaskState.SKIPPED]


def test_a_clock_that_is_set_back_deletes_again(store: TaskStore) -> None:
    manager = TaskManager(store, keeps=DAY)
    manager.tidy(NINE)
    over = store.add(Task(0, MissionText("wave"), "ann", NINE, TaskState.COMPLETED, ended=NINE - 9 * DAY))
    manager.tidy(NINE)
    assert store.task(over.id) is not None
    manager.tidy(NINE - DAY)
    assert store.task(over.id) is None


def test_old_tasks_are_deleted_once_a_day(store: TaskStore) -> None:
    manager = TaskManager(store, keeps=10 * DAY)
    over = store.add(Task(0, MissionText("wave"), "ann", NINE - 20 * DAY, TaskState.COMPLETED, ended=NINE - 11 * DAY))
    waiting = store.add(Task(0, MissionText("wave"), "ann", NINE - 20 * DAY))
    recent = store.add(Task(0, MissionText("wave"), "ann", NINE, TaskState.COMPLETED, ended=NINE - 9.5 * DAY))
    manager.tidy(NINE)
    assert [store.task(each.id) is None for each in (over, waiting, recent)] == [True, False, False]
    manager.tidy(NINE + 0.9 * DAY)
    assert store.task(recent.id) is not None
    manager.tidy(NINE + DAY)
    assert (store.task(recent.id), store.task(waiting.id)) == (None, waiting)
    TaskManager(store).tidy(NINE + 999 * DAY)
    assert store.changes()


def test_all_times_that_were_missed_are_made_up_for(store: TaskStore) -> None:
    """Also where a task of a schedule doesn't wait for the one before: these don't overlap."""
    manager = TaskManager(store)
    add_schedule(store, missed=Missed.ALL, overlap=Overlap.SKIP)
    manager.refresh(NINE + 3 * DAY + 3600)
    assert states(store) == [TaskState.QUEUED] * 4
    manager.refresh(NINE + 4 * DAY)
    assert states(store) == [*[TaskState.QUEUED] * 4, TaskState.SKIPPED]


def test_who_waits_for_long_comes_before_a_stream_of_others(store: TaskStore) -> None:
    manager = TaskManager(store)
    patient = store.add(Task(0, MissionText("wave"), "ann", NINE))
    never = store.add(Task(0, MissionText("wave"), "ann", NINE, priority=-20))
    turns = []
    for minute in range(0, 180, 5):
        now = NINE + 60.0 * minute
        store.add(Task(0, MissionText("nod"), "bob", now, priority=5))
        claimed = manager.claim(now)
        assert claimed is not None
        if claimed.id == patient.id:
            turns.append(minute)
    assert turns == [50]  # a task of ten minutes counts as one of priority
    assert (never_now := store.task(never.id)) is not None
    assert (never_now.state, never_now.priority, never_now.bonus) == (TaskState.QUEUED, -20, 10)


def test_who_has_waited_interrupts_nobody(store: TaskStore) -> None:
    manager = TaskManager(store)
    under_way = store.add(Task(0, MissionText("wave"), "ann", NINE, priority=3))
    assert (claimed := manager.claim(NINE)) is not None
    store.add(Task(0, MissionText("nod"), "ann", NINE))
    assert claimed.id == under_way.id
    store.age(NINE + DAY, 600.0, 10)
    assert not manager.is_more_urgent(claimed, NINE + DAY)


def test_a_task_comes_right_before_another_one(store: TaskStore) -> None:
    def order() -> list[int]:
        return [task.id for task in store.tasks()]

    for _ in range(5):
        store.add(Task(0, MissionText("wave"), "ann", NINE))
    store.add(Task(0, MissionText("wave"), "ann", NINE, priority=2))
    assert order() == [6, 1, 2, 3, 4, 5]
    for moved, before, expected in (
        (5, 3, [6, 1, 2, 5, 3, 4]), (1, 4, [6, 2, 5, 3, 1, 4]), (4, 6, [4, 6, 2, 5, 3, 1]), (6, 5, [4, 2, 6, 5, 3, 1])
    ):  # fmt: skip
        store.move_before(moved, before)
        assert order() == expected
    assert store.move_before(1, 99) is None

"""What a store keeps and finds again, in SQLite and in PostgreSQL."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.store.database import StoreError
from btlang.task.store.records import (
    ACTIVE,
    FINAL,
    WAITING,
    Act,
    LibraryKind,
    Missed,
    MissionText,
    Overlap,
    Restart,
    Revision,
    Schedule,
    Task,
    TaskChange,
    TaskState,
)
from btlang.task.store.task_store import TaskStore, open_store
from tests.task.places import a_task, execute_at

FULL = Task(
    0, MissionText("go to the lab\nthen wave", "tour", 3, {"speed": 0.5, "names": ["Ö", "\0"]}), "ada", 1.25,
    TaskState.BLOCKED, -7, ("night", 'the "lab"', "a\nb"), 2.5, 3.5, Restart.RESUME, ("base", "voice"), 4, 5.5, 6, 7,
    8.5, 9.5, "it's dark 🌙", '{"tree": 1}', "t0ken", "runs/1.mcap",
)  # fmt: skip
PLAN = Schedule(
    0, "every day at 9:00", "Europe/Berlin", MissionText("wave", values={"n": 1}), "bo", 1.5, 10.0, 5, ("a", "b"),
    Restart.AGAIN, Overlap.REPLACE, Missed.ONCE, 600.0,
)  # fmt: skip


def reason(error: pytest.ExceptionInfo[StoreError]) -> str:
    """Why the store can't be used."""
    [told] = error.value.diagnostics
    assert told.code == "BT195"
    return told.message.partition("can't be used: ")[2]


def test_a_task_is_found_again(store: TaskStore, place: str) -> None:
    added = store.add(FULL, "submitted")
    assert added == FULL.replace(id=1)
    assert added.id == store.tasks()[0].id
    assert store.add(a_task()).id == 2
    store.close()
    with open_store(place) as again:
        found = again.task(1)
        assert found == added
        assert found is not None
        assert [type(getattr(found, field)) for field in found.fields] == [type(getattr(FULL, f)) for f in FULL.fields]
        assert again.task(2) == a_task().replace(id=2)
        assert again.task(3) is None
        assert again.changes(1) == [(1, TaskChange(1, 1.25, TaskState.BLOCKED, "submitted", "ada"))]


def test_tasks_are_found_in_the_order_of_their_turn(store: TaskStore) -> None:
    urgent = store.add(a_task(priority=5))
    usual = [store.add(a_task(position=position)).id for position in (2, 1, 2, -1)]
    last = store.add(a_task(priority=-3))
    assert [task.id for task in store.tasks()] == [urgent.id, usual[3], usual[1], usual[0], usual[2], last.id]
    assert [task.id for task in store.tasks(newest=True)] == [6, 5, 4, 3, 2, 1]
    assert [task.id for task in store.tasks(limit=2)] == [urgent.id, usual[3]]
    assert [store.tasks(limit=0), store.tasks(limit=-1)] == [[], []]


def test_tasks_are_found_by_state_and_schedule(store: TaskStore) -> None:
    by_state = {state: store.add(a_task(state=state, schedule=len(state))) for state in TaskState}
    assert store.tasks([TaskState.FAILED]) == [by_state[TaskState.FAILED]]
    assert store.tasks([TaskState.FAILED, TaskState.QUEUED]) == [by_state[TaskState.QUEUED], by_state[TaskState.FAILED]]
    for states in (FINAL, WAITING, ACTIVE):
        assert {task.state for task in store.tasks(states)} == states
    assert store.tasks([]) == []
    assert [task.state for task in store.tasks(schedule=7)] == [
        TaskState.STANDBY,
        TaskState.DELAYED,
        TaskState.BLOCKED,
        "skipped",
    ]
    assert store.tasks([TaskState.QUEUED], schedule=7) == []


LABELS = ("lab", "the lab", 'the "lab"', ", ", ",", '"', "a\nb", "LAB", "%", "\\", "Ö", "[\n")


def test_tasks_are_found_by_label_and_not_by_a_part_of_one(store: TaskStore) -> None:
    store.add(a_task(labels=("x", "the labs", 'x"lab"', "la", "b", "_", "a", "Lab")))
    store.add(a_task())
    labelled = [
        store.add(a_task(labels=labels))
        for label in LABELS
        for labels in ((label,), ("a", label), (label, "b"), ("a", label, "b"))
    ]
    for label in LABELS:
        assert store.tasks(label=label) == [task for task in labelled if label in task.labels]
        assert store.count_tasks({TaskState.QUEUED}, label=label) == len(store.tasks(label=label))
    assert (store.count_tasks(), store.count_tasks([]), store.count_tasks(schedule=3)) == (len(store.tasks()), 0, 0)
    assert len(store.tasks(limit=2**70)) == len(store.tasks())


def test_a_change_needs_the_state_before(store: TaskStore) -> None:
    task = store.add(a_task(), "submitted")
    assert store.change(task.id, ACTIVE, TaskState.COMPLETED, time=1.0) is None
    assert store.change(99, TaskState, TaskState.COMPLETED, time=1.0) is None
    assert store.change(task.id, (), TaskState.COMPLETED, time=1.0) is None
    begun = store.change(
        task.id, WAITING, TaskState.UNDERWAY, time=2.0, cause="it began", person="bo", started=2.0, needs=("base",)
    )
    assert begun == task.replace(state=TaskState.UNDERWAY, reason="it began", started=2.0, needs=("base",))
    assert store.task(task.id) == begun
    assert store.changes() == [
        (1, TaskChange(task.id, 100.0, TaskState.QUEUED, "submitted", "ada")),
        (2, TaskChange(task.id, 2.0, TaskState.UNDERWAY, "it began", "bo")),
    ]


def test_a_final_state_is_final(store: TaskStore) -> None:
    for final in sorted(FINAL):
        task = store.add(a_task())
        ended = store.change(task.id, [TaskState.QUEUED], final, time=3.0, cause="so", ended=3.0)
        assert ended is not None
        assert store.change(task.id, list(TaskState), TaskState.QUEUED, time=4.0) is None
        assert store.task(task.id) == ended
        assert len(store.changes(task.id)) == 2


def test_fields_are_amended_without_a_change(store: TaskStore) -> None:
    task = store.add(a_task())
    fields: dict[str, Any] = {"priority": 9, "earliest": 5.0, "labels": ("x",), "saved": "{}", "recording": "a.mcap"}
    assert store.amend(task.id, **fields) == task.replace(**fields) == store.task(task.id)
    assert store.amend(task.id) == store.task(task.id)
    assert store.amend(99, priority=1) is None
    assert len(store.changes()) == 1


def test_what_is_no_field_to_amend_is_a_mistake_of_the_program(store: TaskStore) -> None:
    task = store.add(a_task())
    for field in ("state", "colour", "priority = 1 --"):
        with pytest.raises(TypeError, match="can't be set here"):
            store.amend(task.id, **{field: "failed"})
        with pytest.raises(TypeError):
            store.change(task.id, [TaskState.QUEUED], TaskState.FAILED, time=1.0, **{field: "red"})
        with pytest.raises(TypeError):
            store.amend_schedule(1, **{field: 1})
    assert store.tasks() == [task]


def test_the_next_task_is_claimed(store: TaskStore) -> None:
    store.add(a_task(state=TaskState.DELAYED, token="t", priority=9))
    store.add(a_task(state=TaskState.BLOCKED, priority=9))
    store.add(a_task(deadline=9.0, priority=9))
    later = store.add(a_task(earliest=11.0, priority=9))
    delayed = store.add(a_task(state=TaskState.DELAYED, priority=1, attempts=2))
    queued = store.add(a_task(earliest=10.0, deadline=10.0))
    assert store.peek(10.0) == delayed
    claimed = store.claim(10.0)
    assert claimed == delayed.replace(state=TaskState.STANDBY, attempts=3, reason="its turn") == store.task(delayed.id)
    assert store.changes(delayed.id)[1:] == [(7, TaskChange(delayed.id, 10.0, TaskState.STANDBY, "its turn", ""))]
    second = store.claim(10.0)
    assert (second and second.id) == queued.id
    assert (store.claim(10.0), store.peek(10.0)) == (None, None)
    third = store.claim(11.0)
    assert (third and third.id) == later.id


def test_what_time_brings(store: TaskStore) -> None:
    assert (store.overdue(9.0), store.next_time(9.0)) == ([], None)
    late = [store.add(a_task(deadline=deadline, priority=priority)) for deadline, priority in ((8.0, 0), (8.5, 1))]
    store.add(a_task(deadline=7.0, state=TaskState.BLOCKED))
    store.add(a_task(earliest=20.0, deadline=30.0))
    store.add_schedule(PLAN.replace(next=25.0))
    assert store.overdue(8.5) == late[:1]
    assert store.overdue(9.0) == late[::-1]
    assert [store.next_time(now) for now in (7.0, 8.0, 9.0, 20.0, 25.0, 30.0)] == [8.0, 8.5, 20.0, 25.0, 30.0, None]


def test_changes_are_read_on(store: TaskStore) -> None:
    for _ in range(3):
        store.change(store.add(a_task()).id, [TaskState.QUEUED], TaskState.SKIPPED, time=5.0)
    everything = store.changes()
    assert [number for number, _ in everything] == [1, 2, 3, 4, 5, 6]
    assert store.changes(after=4) == everything[4:]
    assert store.changes(limit=2) == everything[:2]
    assert store.changes(2) == everything[2:4]
    assert store.changes(2, after=3, limit=5) == everything[3:4]
    assert store.changes(9) == []


def test_schedules(store: TaskStore) -> None:
    plan = store.add_schedule(PLAN)
    assert plan == PLAN.replace(id=1)
    other = store.add_schedule(PLAN.replace(next=4.0, within=None))
    done = store.add_schedule(PLAN.replace(next=None))
    assert [store.schedule(id) for id in (1, 2, 3, 4)] == [plan, other, done, None]
    assert store.schedules() == [plan, other, done]
    assert [store.due_schedules(now) for now in (3.9, 4.0, 10.0)] == [[], [other], [other, plan]]
    moved = store.amend_schedule(2, next=20.0, labels=())
    assert moved == other.replace(next=20.0, labels=()) == store.schedule(2)
    assert store.amend_schedule(9, next=1.0) is None
    assert [store.delete_schedule(2), store.delete_schedule(2)] == [True, False]
    assert store.add_schedule(PLAN).id == 4


def test_the_library_keeps_every_revision(store: TaskStore) -> None:
    first = store.put_text("tour", "wave", "ada", 1.0)
    assert first == Revision("tour", 1, "wave", "ada", 1.0)
    assert store.put_text("tour", "wave", "bo", 2.0) == first
    second = store.put_text("tour", "nod", "bo", 3.0)
    store.put_text("Zoo", "wave", "ada", 4.0)
    assert store.put_text("tour", "wave", "ada", 5.0).number == 3
    assert [revision.text for revision in store.revisions("tour")] == ["wave", "nod", "wave"]
    assert [store.text("tour", number) for number in (1, 2, 4)] == [first, second, None]
    assert [revision.name for revision in store.texts()] == ["Zoo", "tour"]
    assert store.texts()[1] == store.text("tour") == Revision("tour", 3, "wave", "ada", 5.0)
    assert [store.delete_text(name, "bo", 6.0) for name in ("tour", "tour", "park")] == [True, False, False]
    assert store.revisions("tour")[3:] == [Revision("tour", 4, "", "bo", 6.0, True)]
    assert [store.text("tour"), store.text("tour", 4), store.text("tour", 2)] == [None, None, second]
    assert [revision.name for revision in store.texts()] == ["Zoo"]
    assert store.put_text("tour", "wave", "ada", 7.0).number == 5


def test_each_kind_of_text_has_names_of_its_own(store: TaskStore) -> None:
    kept = [store.put_text("tour", kind, "ada", 1.0, 0, kind) for kind in LibraryKind]
    assert [revision and revision.number for revision in kept] == [1] * len(LibraryKind)
    assert [store.texts(kind) for kind in LibraryKind] == [[revision] for revision in kept]
    assert store.put_text("tour", "other", "ada", 2.0, 0, LibraryKind.WORLD) is None
    assert store.delete_text("tour", "bo", 3.0, LibraryKind.WORLD)
    assert [store.text("tour", kind=kind) for kind in LibraryKind] == [kept[0], None, *kept[2:]]
    deleted = Revision("tour", 2, "", "bo", 3.0, True, LibraryKind.WORLD)
    assert [store.revisions("tour", kind) for kind in LibraryKind] == [
        [kept[0]], [kept[1], deleted], *([each] for each in kept[2:])
    ]  # fmt: skip


def test_the_audit_trail_and_settings(store: TaskStore) -> None:
    acts = [Act(time, "ada", "submit", '{"text": "wave"}', f"task {time}") for time in (3.0, 1.0, 2.0)]
    for act in acts:
        store.log(act)
    assert store.acts() == acts[::-1]
    assert store.acts(limit=1) == acts[2:]
    assert store.setting("paused") == ""
    for value in ("yes", "no"):
        store.set_setting("paused", value)
    assert (store.setting("paused"), store.setting("Paused")) == ("no", "")


def test_cleaning_spares_what_is_not_over_and_the_library(store: TaskStore) -> None:
    kept = [store.add(a_task(state=state, created=1.0)) for state in TaskState if state not in FINAL]
    for state in FINAL:
        store.change(store.add(a_task(created=1.0)).id, [TaskState.QUEUED], state, time=5.0, ended=5.0)
    unsaid = store.add(a_task(created=1.0))
    store.change(unsaid.id, [TaskState.QUEUED], TaskState.SKIPPED, time=8.0)
    late = store.add(a_task(state=TaskState.FAILED, ended=10.0, created=1.0))
    store.put_text("tour", "wave", "ada", 1.0)
    for time in (4.0, 10.0):
        store.log(Act(time, "ada", "say", "", ""))
    assert store.clean(5.0) == 0
    assert store.clean(8.0) == len(FINAL)
    assert store.clean(10.0) == 1
    assert store.tasks(newest=True) == [late, *reversed(kept)]
    assert {change.task for _, change in store.changes()} == {task.id for task in [*kept, late]}
    assert [act.time for act in store.acts()] == [10.0]
    assert len(store.texts()) == 1
    assert store.add(a_task()).id == late.id + 1


def test_numbers_are_never_given_again(store: TaskStore) -> None:
    task = store.add(a_task(state=TaskState.SKIPPED, created=1.0))
    assert store.clean(2.0) == 1
    assert (store.add(a_task()).id, store.changes()[0][0]) == (task.id + 1, 2)


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"reason": "a\0b"}, "it can't keep a text with a NUL character."),
    ({"token": "\ud800"}, "it can't keep half a character (a lone surrogate)."),
    ({"earliest": math.nan}, "it can't keep NaN, which isn't a number."),
]


def test_what_cannot_be_kept_is_refused(store: TaskStore) -> None:
    task = store.add(a_task())
    for fields, told in REFUSED:
        for call in (partial(store.add, a_task(**fields)), partial(store.amend, task.id, **fields)):
            with pytest.raises(StoreError) as error:
                call()
            assert reason(error) == told
    assert (store.tasks(), len(store.changes())) == ([task], 1)
    assert store.add(a_task()).id == task.id + 1


def test_numbers_and_values_that_are_too_much(store: TaskStore) -> None:
    deep: list[Any] = []
    for _ in range(100_000):
        deep = [deep]
    for task in (a_task(position=2**70), Task(0, MissionText("wave", values={"x": deep}), "ada", 1.0)):
        with pytest.raises(StoreError):
            store.add(task)
    assert store.tasks() == []
    assert store.add(a_task(earliest=math.inf, deadline=-math.inf)).id == 1
    assert [(task.earliest, task.deadline) for task in store.tasks()] == [(math.inf, -math.inf)]


def test_a_closed_store_says_so(store: TaskStore) -> None:
    store.close()
    store.close()
    with pytest.raises(StoreError) as error:
        store.tasks()
    assert reason(error) == "it has been closed."


def test_one_owner(store: TaskStore, place: str) -> None:
    store.own()
    store.own()
    with open_store(place) as other:
        with pytest.raises(MissionError, match="BT197"):
            other.own()
        other.add(a_task())
        assert other.claim(200.0) is not None
        store.close()
        other.own()


def test_a_row_that_cannot_be_read_is_damage(store: TaskStore, place: str) -> None:
    good, bad = store.add(a_task()), store.add(a_task())
    execute_at(place, f"UPDATE task SET state = 'asleep' WHERE id = {bad.id}")
    with pytest.raises(StoreError) as error:
        store.tasks()
    assert reason(error) == "it's damaged: a task can't be read."
    assert store.task(good.id) == good
    with pytest.raises(StoreError):
        store.amend(bad.id, priority=4)
    execute_at(place, f"UPDATE task SET state = 'queued' WHERE id = {bad.id}")
    assert store.task(bad.id) == bad

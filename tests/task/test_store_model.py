"""Random work on a store gives what it gives on a model of plain dictionaries."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule, run_state_machine_as_test

from btlang.task.store.backup import restore_backup
from btlang.task.store.records import (
    FINAL,
    Act,
    LibraryKind,
    MissionText,
    Restart,
    Revision,
    Schedule,
    Task,
    TaskChange,
    TaskState,
)
from btlang.task.store.task_store import open_store
from tests.profiles import amount
from tests.task.places import new_place

TIMES = st.integers(0, 6).map(lambda half: half / 2)
SOMETIMES = st.none() | TIMES
TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=6)
LABELS = st.sampled_from(["lab", "la", 'a"b', "x, y"])
IDS = st.integers(1, 5)
STATES = st.sets(st.sampled_from(TaskState), min_size=3) | st.just(set(TaskState)) | st.sets(st.sampled_from(TaskState))
NAMES = st.sampled_from(["tour", "Tour", "zoo"])
KINDS = st.sampled_from([LibraryKind.MISSION, LibraryKind.WORLD])
FIELDS = st.fixed_dictionaries(
    {},
    optional={
        "priority": st.integers(-2, 2),
        "position": st.integers(-(2**63), 2**63 - 1) | st.integers(0, 2),
        "earliest": SOMETIMES,
        "deadline": SOMETIMES,
        "started": SOMETIMES,
        "token": st.sampled_from(["", "t"]),
        "labels": st.lists(LABELS, max_size=3).map(tuple),
        "saved": TEXTS,
        "ended": SOMETIMES,
        "schedule": st.integers(0, 2),
        "restart": st.sampled_from(Restart),
    },
)
VALUES = st.dictionaries(TEXTS, st.integers() | TEXTS | st.lists(st.booleans()), max_size=2)


def turn(task: Task) -> tuple[int, int, int]:
    """What tasks are sorted by."""
    return -task.priority, task.position, task.id


class Work(RuleBasedStateMachine):
    """What a task layer may do with its store."""

    kind = "sqlite"

    @initialize(fields=st.lists(FIELDS, min_size=2, max_size=5))
    def begin(self, fields: list[dict[str, Any]]) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.place = new_place(self.kind, Path(self.folder.name))
        self.store = open_store(self.place)
        self.tasks: dict[int, Task] = {}
        self.changes: dict[int, TaskChange] = {}
        self.schedules: dict[int, Schedule] = {}
        self.revisions: list[Revision] = []
        self.acts: list[Act] = []
        self.settings: dict[str, str] = {}
        self.counts = {"task": 0, "change": 0, "schedule": 0}
        for some in fields:
            self.add_task(some, TaskState.QUEUED, "", {}, 0.0)

    def teardown(self) -> None:
        if hasattr(self, "store"):
            self.store.close()
            self.folder.cleanup()

    def note(self, task: Task, time: float, cause: str, person: str) -> None:
        self.tasks[task.id] = task
        self.counts["change"] += 1
        self.changes[self.counts["change"]] = TaskChange(task.id, time, task.state, cause, person)

    def ready(self, task: Task, now: float) -> bool:
        if task.state != TaskState.QUEUED and (task.state != TaskState.DELAYED or task.token):
            return False
        in_time = task.started is not None or task.deadline is None or task.deadline >= now
        return (task.earliest or 0) <= now and in_time

    @rule(
        fields=FIELDS,
        state=st.just(TaskState.QUEUED) | st.sampled_from(TaskState),
        text=TEXTS,
        values=VALUES,
        time=TIMES,
    )
    def add(self, fields: dict[str, Any], state: TaskState, text: str, values: dict[str, Any], time: float) -> None:
        self.add_task(fields, state, text, values, time)

    def add_task(
        self, fields: dict[str, Any], state: TaskState, text: str, values: dict[str, Any], time: float
    ) -> None:
        task = Task(0, MissionText(text, values=values), text, time, state, **fields)
        self.counts["task"] += 1
        expected = task.replace(id=self.counts["task"])
        assert self.store.add(task, text) == expected
        self.note(expected, time, text, text)

    @rule(id=IDS, before=STATES, state=st.sampled_from(TaskState), time=TIMES, cause=TEXTS, fields=FIELDS)
    def change(
        self, id: int, before: set[TaskState], state: TaskState, time: float, cause: str, fields: dict[str, Any]
    ) -> None:
        task = self.tasks.get(id)
        expected = None
        if task is not None and task.state in before and task.state not in FINAL:
            expected = task.replace(state=state, reason=cause, **fields)
            self.note(expected, time, cause, "bo")
        assert self.store.change(id, before, state, time=time, cause=cause, person="bo", **fields) == expected

    @rule(id=IDS, fields=FIELDS)
    def amend(self, id: int, fields: dict[str, Any]) -> None:
        task = self.tasks.get(id)
        expected = None if task is None else task.replace(**fields)
        if expected is not None:
            self.tasks[id] = expected
        assert self.store.amend(id, **fields) == expected

    @rule(now=TIMES)
    def claim(self, now: float) -> None:
        ready = sorted((task for task in self.tasks.values() if self.ready(task, now)), key=turn)
        assert self.store.peek(now) == (ready[0] if ready else None)
        expected = None
        if ready:
            attempts = ready[0].attempts + 1
            expected = ready[0].replace(state=TaskState.STANDBY, attempts=attempts, reason="its turn")
            self.note(expected, now, "its turn", "")
        assert self.store.claim(now) == expected

    @rule(now=TIMES)
    def wait(self, now: float) -> None:
        queued = [task for task in sorted(self.tasks.values(), key=turn) if task.state is TaskState.QUEUED]
        unbegun = [task for task in queued if task.started is None]
        overdue = [task for task in unbegun if task.deadline is not None and task.deadline < now]
        assert self.store.overdue(now) == overdue
        times = [plan.next for plan in self.schedules.values()]
        times += [task.earliest for task in queued] + [task.deadline for task in unbegun]
        assert self.store.next_time(now) == min(
            (time for time in times if time is not None and time > now), default=None
        )

    @rule(
        states=st.none() | STATES, label=st.just("") | LABELS, schedule=st.integers(0, 2), newest=st.booleans(),
        limit=st.none() | st.integers(0, 3),
    )  # fmt: skip
    def ask(self, states: set[TaskState] | None, label: str, schedule: int, newest: bool, limit: int | None) -> None:
        found = [
            task
            for task in sorted(self.tasks.values(), key=(lambda task: -task.id) if newest else turn)
            if (states is None or task.state in states)
            and (not label or label in task.labels)
            and schedule in (0, task.schedule)
        ][:limit]
        assert self.store.tasks(states, label=label, schedule=schedule, newest=newest, limit=limit) == found

    @rule(after=st.integers(0, 9), task=st.none() | IDS, limit=st.none() | st.integers(0, 3))
    def read_on(self, after: int, task: int | None, limit: int | None) -> None:
        found = [
            (number, change)
            for number, change in self.changes.items()
            if number > after and task in (None, change.task)
        ][:limit]  # fmt: skip
        assert self.store.changes(task, after, limit) == found

    @rule(rule_=TEXTS, next=SOMETIMES, values=VALUES)
    def plan(self, rule_: str, next: float | None, values: dict[str, Any]) -> None:
        schedule = Schedule(0, rule_, "UTC", MissionText("wave", values=values), "ada", 1.0, next)
        self.counts["schedule"] += 1
        expected = schedule.replace(id=self.counts["schedule"])
        assert self.store.add_schedule(schedule) == expected
        self.schedules[expected.id] = expected

    @rule(id=IDS, next=SOMETIMES, delete=st.booleans(), now=TIMES)
    def replan(self, id: int, next: float | None, delete: bool, now: float) -> None:
        known = self.schedules.get(id)
        if delete:
            assert self.store.delete_schedule(id) == (self.schedules.pop(id, None) is not None)
        else:
            expected = None if known is None else known.replace(next=next)
            assert self.store.amend_schedule(id, next=next) == expected
            if expected is not None:
                self.schedules[id] = expected
        due = [plan for plan in self.schedules.values() if plan.next is not None and plan.next <= now]
        assert self.store.due_schedules(now) == sorted(due, key=lambda plan: (plan.next, plan.id))

    def known(self, name: str, kind: LibraryKind) -> list[Revision]:
        """The revisions of a text."""
        return [revision for revision in self.revisions if (revision.name, revision.kind) == (name, kind)]

    @rule(name=NAMES, text=st.sampled_from(["wave", "nod"]), time=TIMES, kind=KINDS)
    def put(self, name: str, text: str, time: float, kind: LibraryKind) -> None:
        known = self.known(name, kind)
        if not known or known[-1].deleted or known[-1].text != text:
            known.append(Revision(name, len(known) + 1, text, "ada", time, kind=kind))
            self.revisions.append(known[-1])
        assert self.store.put_text(name, text, "ada", time, kind=kind) == known[-1]

    @rule(name=NAMES, time=TIMES, kind=KINDS)
    def delete(self, name: str, time: float, kind: LibraryKind) -> None:
        known = self.known(name, kind)
        there = bool(known) and not known[-1].deleted
        if there:
            self.revisions.append(Revision(name, len(known) + 1, "", "bo", time, True, kind))
        assert self.store.delete_text(name, "bo", time, kind) == there

    @rule(name=NAMES, number=st.integers(0, 4), kind=KINDS)
    def look_up(self, name: str, number: int, kind: LibraryKind) -> None:
        known = self.known(name, kind)
        found = [revision for revision in known if number in (0, revision.number)]
        assert self.store.text(name, number, kind) == (None if not found or found[-1].deleted else found[-1])
        assert self.store.revisions(name, kind) == known

    @rule(text=TEXTS, time=TIMES, name=NAMES)
    def write_down(self, text: str, time: float, name: str) -> None:
        self.acts.append(Act(time, "ada", text, text, text))
        self.store.log(self.acts[-1])
        self.settings[name] = text
        self.store.set_setting(name, text)

    @rule(before=TIMES)
    def clean(self, before: float) -> None:
        def end(task: Task) -> float:
            return max(c.time for c in self.changes.values() if c.task == task.id) if task.ended is None else task.ended

        gone = [id for id, task in self.tasks.items() if task.state in FINAL and end(task) < before]
        assert self.store.clean(before) == len(gone)
        self.tasks = {id: task for id, task in self.tasks.items() if id not in gone}
        self.changes = {number: change for number, change in self.changes.items() if change.task not in gone}
        self.acts = [act for act in self.acts if act.time >= before]

    @rule(kind=st.sampled_from(["same", "sqlite"]))
    def go_through_a_backup(self, kind: str) -> None:
        self.store.close()
        backup = Path(self.folder.name, f"backup{len(list(Path(self.folder.name).iterdir()))}")
        with open_store(self.place) as store:
            store.backup(str(backup))
        self.place = new_place(self.kind if kind == "same" else kind, Path(self.folder.name))
        restore_backup(str(backup), self.place)
        self.store = open_store(self.place)

    @invariant()
    def is_as_the_model(self) -> None:
        if not hasattr(self, "store"):
            return
        assert self.store.tasks() == sorted(self.tasks.values(), key=turn)
        assert dict(self.store.changes()) == self.changes
        assert self.store.schedules() == list(self.schedules.values())
        for kind in LibraryKind:
            latest = {revision.name: revision for revision in self.revisions if revision.kind is kind}
            assert self.store.texts(kind) == [latest[name] for name in sorted(latest) if not latest[name].deleted]
        assert self.store.acts() == self.acts[::-1]
        assert {name: self.store.setting(name) for name in self.settings} == self.settings


@pytest.mark.long
@pytest.mark.parametrize("kind", ["sqlite", "postgres"])
def test_random_work(kind: str) -> None:
    work = type("Work", (Work,), {"kind": kind})
    much = {"max_examples": amount(8, 150), "stateful_step_count": amount(25, 50)}
    run_state_machine_as_test(work, settings=settings(**much))

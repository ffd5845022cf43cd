"""Random commands against a plain model of the queue: the same states and order, and refusals where it says so."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from btlang.task.layer import TaskLayer
from btlang.task.task import State
from tests.profiles import amount

PRIORITIES = st.integers(-2, 2)


class Commands(RuleBasedStateMachine):
    """A robot whose executor the test drives. The model has the priority, position and state of each task."""

    def __init__(self) -> None:
        super().__init__()
        self.folder = Path(tempfile.mkdtemp())
        self.layer = TaskLayer(folder=str(self.folder), speed="max")
        self.tasks: dict[int, list[Any]] = {}
        self.paused = self.stopped = False

    def teardown(self) -> None:
        self.layer.close()
        shutil.rmtree(self.folder)

    def ask(self, command: str, **fields: Any) -> bool:
        return self.layer.handle({"command": command, **fields}, "ann").ok

    def waiting(self) -> list[int]:
        found = [number for number, (_, _, state) in self.tasks.items() if state is State.QUEUED]
        return sorted(found, key=lambda number: (-self.tasks[number][0], self.tasks[number][1], number))

    def some(self, number: int) -> int:
        return number % (len(self.tasks) + 2)

    @rule(priority=PRIORITIES)
    def submit(self, priority: int) -> None:
        answer = self.layer.handle({"command": "submit", "text": "print hi", "priority": priority}, "ann")
        number = answer.data["task"]["id"]
        assert number not in self.tasks
        self.tasks[number] = [priority, 0, State.QUEUED]

    @rule(priority=st.integers(-1000, 1000).filter(lambda priority: abs(priority) > 100))
    def submit_wrongly(self, priority: int) -> None:
        assert not self.ask("submit", text="print hi", priority=priority)
        assert not self.ask("submit", text="frobnicate")

    @rule(
        number=st.integers(0, 50),
        act=st.sampled_from([("cancel", State.CANCELED), ("kill", State.KILLED), ("skip", State.SKIPPED)]),
    )
    def end(self, number: int, act: tuple[str, State]) -> None:
        number = self.some(number)
        is_open = number in self.tasks and self.tasks[number][2] is State.QUEUED
        assert self.ask(act[0], task=number) is is_open
        if is_open:
            self.tasks[number][2] = act[1]

    @rule(number=st.integers(0, 50))
    def interrupt_what_is_not_under_way(self, number: int) -> None:
        assert not self.ask("interrupt", task=self.some(number))
        assert not self.ask("resume", task=max(1, self.some(number)), token="x")

    @rule(number=st.integers(0, 50))
    def again(self, number: int) -> None:
        number = self.some(number)
        answer = self.layer.handle({"command": "again", "task": number}, "bob")
        assert answer.ok is (number in self.tasks)
        if answer.ok:
            self.tasks[answer.data["task"]["id"]] = [self.tasks[number][0], 0, State.QUEUED]

    @rule(number=st.integers(0, 50), priority=PRIORITIES)
    def move(self, number: int, priority: int) -> None:
        number = self.some(number)
        is_open = number in self.tasks and self.tasks[number][2] is State.QUEUED
        assert self.ask("reorder", task=number, priority=priority) is is_open
        if is_open:
            self.tasks[number][0] = priority

    @rule(number=st.integers(0, 50), other=st.integers(0, 50))
    def move_before(self, number: int, other: int) -> None:
        waiting = self.waiting()
        if len(waiting) < 2:
            return
        number, other = waiting[number % len(waiting)], waiting[other % len(waiting)]
        if number == other:
            return
        assert self.ask("reorder", task=number, before=other)
        waiting.remove(number)
        waiting.insert(waiting.index(other), number)
        priority = self.tasks[other][0]
        self.tasks[number][0] = priority
        equal = [each for each in waiting if self.tasks[each][0] == priority]
        for position, each in enumerate(equal):
            self.tasks[each][1] = position - len(equal)

    @rule()
    def pause(self) -> None:
        assert self.ask("pause")
        self.paused = True

    @rule()
    def resume(self) -> None:
        assert self.ask("resume")
        self.paused = False

    @rule()
    def stop(self) -> None:
        assert self.ask("emergency_stop")
        self.stopped = True

    @rule()
    def release(self) -> None:
        assert self.ask("release")
        self.stopped = False

    @precondition(lambda self: self.waiting() or self.paused or self.stopped)
    @rule()
    def work(self) -> None:
        self.layer.executor._turn()
        if not (self.paused or self.stopped):
            self.tasks[self.waiting()[0]][2] = State.COMPLETED

    @invariant()
    def states_are_those_of_the_model(self) -> None:
        found = {task.id: task.state for task in self.layer.store.tasks()}
        assert found == {number: state for number, (_, _, state) in self.tasks.items()}

    @invariant()
    def the_order_is_that_of_the_model(self) -> None:
        listed = self.layer.handle({"command": "list"}, "ann").data["tasks"]
        assert [task["id"] for task in listed] == self.waiting()


class TestCommands(Commands.TestCase):  # type: ignore[misc, name-defined]
    """Few sequences in each run of the suite, 10,000 in a long one."""

    settings = settings(max_examples=amount(25, 10_000), stateful_step_count=20, deadline=None)


TestCommands.runTest = pytest.mark.long(TestCommands.runTest)

"""A robot whose executor a test drives: it works for one turn at a time, in the thread of the test."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from btlang.run.events import Event, PeriodPassed, Printed
from btlang.task.layer import TaskLayer
from btlang.task.messages import Answer
from btlang.task.store.records import Task

from .places import new_place

HOUR = 3600.0
_TABLES = ("task", "change", "schedule", "revision", "act", "setting")


class Driven:
    """One database and one robot for many tests of a kind of store: `empty` makes both as new, which takes a moment.

    `prepared` is called before the run of a task, `printed` gets what it prints, in the tick in which it does; `ticked`
    is called after that tick.
    """

    def __init__(self, kind: str) -> None:
        self._folder = Path(tempfile.mkdtemp())
        self._place = new_place(kind, self._folder)
        self.prepared: Callable[[], object] = lambda: None
        self.printed: Callable[[int, str], object] = lambda task, text: None
        self.ticked: Callable[[], object] = lambda: None
        self.layer = self._up(0.0)
        self.begins = 0.0
        self.has_crashed = False
        """It does nothing more until `restart`."""
        self._problem: Exception | None = None

    def close(self) -> None:
        """May not be used afterwards."""
        self.layer.close()
        shutil.rmtree(self._folder)

    def empty(self) -> None:
        """As it was at the beginning, but the time goes on."""
        with self.layer.store._database.transaction() as execute:
            for table in _TABLES:
                execute(f"DELETE FROM {table}")
            execute("UPDATE counter SET value = 0")
        self.ask("resume")
        self.ask("release")
        self.begins = self.layer.now()

    def ask(self, command: str, **fields: Any) -> Answer:
        """A command."""
        return self.layer.handle({"command": command, **fields}, "ann")

    def hours_pass(self, hours: int) -> None:
        """In no time."""
        self.layer._begins += hours * HOUR

    def turn(self) -> None:
        """One task, as far as it goes, if one may begin."""
        self.layer.executor._turn()
        problem, self._problem = self._problem, None
        if problem is not None:
            raise problem

    def crash(self) -> None:
        """In the middle of a task: from now on the store gets nothing, as from a process that was killed."""
        self.has_crashed = True
        self.layer.store.close()
        self.layer.halt()

    def restart(self) -> None:
        """The process ends and comes back; what is in the store is all that it knows."""
        now = self.layer.now()
        self.layer.close()
        self.layer, self.has_crashed = self._up(now), False

    def _up(self, begins: float) -> TaskLayer:
        layer = TaskLayer(folder=str(self._folder), store=self._place, speed="max", begins=begins, sinks=self._listen)
        layer.executor._idle = lambda: None  # type: ignore[method-assign]  # a turn without a task is over at once
        layer.manager.recover(layer.now(), layer.emergency.reason)
        return layer

    def _listen(self, task: Task | None, *_: object) -> list[Any]:
        assert task is not None
        self.heed(self.prepared)
        return [_Ear(task, self)]

    def heed(self, call: Callable[..., object], *arguments: object) -> None:
        """Calls it in the middle of a task; `turn` raises what it raises, for which else the mission would fail."""
        try:
            if not self.has_crashed:
                call(*arguments)
        except Exception as problem:
            self._problem = problem
            self.crash()


class _Ear:
    """Hears what one run of a task prints."""

    policy = "inline"

    def __init__(self, task: Task, robot: Driven) -> None:
        self._task, self._robot = task, robot
        self._heard = False

    def __call__(self, event: Event) -> None:
        if isinstance(event, Printed):
            self._heard = True
            self._robot.heed(self._robot.printed, self._task.id, event.text)
        elif isinstance(event, PeriodPassed) and self._heard:
            self._heard = False
            self._robot.heed(self._robot.ticked)

"""Handlers of commands that only read the store, of a robot that is up or down."""

from __future__ import annotations

from collections.abc import Callable

from btlang.task import messages
from btlang.task.commands.answers import act_line, task_data, task_line, write_report
from btlang.task.commands.checks import HIGHEST, choose_member, refusal_error, report_times
from btlang.task.execution.manager import TaskManager
from btlang.task.messages import Answer
from btlang.task.schedule.calendar import format_moment
from btlang.task.store.records import ACTIVE, FINAL, WAITING, Task, TaskState
from btlang.task.store.task_store import TaskStore
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class StoreReader:
    """A handler of the commands about tasks that change nothing, with methods like those of Handler (handler.py).

    `hindrance` gives why no task may begin now, "" if one may; `question` what the task under way asks, "" if nothing.
    """

    def __init__(
        self,
        store: TaskStore,
        manager: TaskManager,
        now: Callable[[], float],
        hindrance: Callable[[], str],
        question: Callable[[], str] = str,
    ) -> None:
        self._store, self._manager, self._now = store, manager, now
        self._hindrance, self._question = hindrance, question

    def list(self, command: messages.List, person: str) -> Answer:
        """List tasks in some states, by default those that aren't over."""
        wanted = {choose_member(TaskState, state, "states", command.tag) for state in command.states}
        states = wanted or WAITING | ACTIVE
        found = self._store.tasks(states, label=command.label, newest=bool(wanted & FINAL), limit=command.limit)
        found.sort(key=lambda task: task.state not in ACTIVE)
        is_cut = command.limit is not None and len(found) >= command.limit
        more = max(self._store.count_tasks(states, label=command.label) - len(found), 0) if is_cut else 0
        hindrance, now = self._hindrance(), self._now()
        first = self._manager.first(now)
        tasks = [task_data(task, self._why_waiting(task, now, hindrance, first)) for task in found]
        lines = [task_line(task) for task in tasks] or [self._none(not wanted)]
        lines += [f"and {more} more: --limit N lists so many, --all every one"] if more else []
        return Answer(True, "\n".join(lines), {"tasks": tasks, "more": more, "hindrance": hindrance})

    def _none(self, only_open: bool) -> str:
        """Say that there are no tasks to list, and how many are over where only the others were asked for."""
        over = self._store.count_tasks(FINAL) if only_open else 0
        if not over:
            return "There are no tasks."
        which = "one that is" if over == 1 else f"{over} that are"
        return f"No task waits or is under way. To see the {which} over: btc task list --all"

    def show(self, command: messages.Show, person: str) -> Answer:
        """Show a task with all that became of it. Raises MissionError (BT187)."""
        task = self.known(command.task)
        now, data = self._now(), self.data(task)
        changes = [change for _, change in self._store.changes(task.id)]
        data["changes"] = [
            {"time": each.time, "state": each.state, "cause": each.cause, "person": each.person} for each in changes
        ]
        lines = [
            task_line(data),
            f"  asked for by {one_line(task.person) or 'nobody'} at {format_moment(task.created, now)}",
        ]
        if task.needs:
            lines.append(f"  needs {', '.join(task.needs)}")
        for each in changes:
            by = f", by {one_line(each.person)}" if each.person else ""
            cause = f": {one_line(each.cause)}" if each.cause else ""
            lines.append(f"  {format_moment(each.time, now)}  {each.state}{cause}{by}")
        if task.recording:
            lines.append(f"  recorded in {one_line(task.recording)}")
        return Answer(True, "\n".join(lines), {"task": {**data, "text": task.mission.text}})

    def report(self, command: messages.Report, person: str) -> Answer:
        """Report what was done, and why something wasn't."""
        since, until = report_times(command.since, command.until, self._now())
        lines = [*write_report(self._store, since, until)]
        return Answer(True, "\n".join(lines), {"lines": lines})

    def trail(self, command: messages.Trail, person: str) -> Answer:
        """List the latest commands that changed something."""
        now, found = self._now(), self._store.acts(command.limit)
        lines = [act_line(each, now) for each in found]
        acts = [each.as_dict() for each in found]
        return Answer(True, "\n".join(lines) or "Nobody has asked for anything.", {"acts": acts})

    def known(self, number: int) -> Task:
        """Return a task. Raises MissionError (BT187) if there's none of this number."""
        task = self._store.task(number) if abs(number) <= HIGHEST else None
        if task is None:
            raise refusal_error(number, "isn't known")
        return task

    def data(self, task: Task) -> dict[str, Any]:
        """Return a task as answers have it."""
        return task_data(task, self._why_waiting(task, self._now(), self._hindrance()))

    def _why_waiting(self, task: Task, now: float, hindrance: str, first: int | None = None) -> str:
        question = self._question() if task.state is TaskState.UNDERWAY else ""
        if question:
            return f'it waits for an answer to "{one_line(question)}"'
        return self._manager.why_waiting(task, now, hindrance, first)

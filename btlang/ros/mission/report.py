"""How missions ended, in words."""

from __future__ import annotations

from btlang.support.record import Record
from btlang.task.execution.executor import NOTHING_TO_DO
from btlang.task.store.records import Task, TaskState

_OUTCOMES = {TaskState.COMPLETED: "success", TaskState.FAILED: "failure", TaskState.ERROR: "failure"}
_PHRASES = {"success": "succeeded", "failure": "failed", "skipped": "had nothing to do", "stopped": "was stopped"}


class Report(Record):
    """`outcome` is "success", "failure", "skipped" or "stopped"; `seconds` are those of the mission."""

    outcome: str
    reason: str = ""
    seconds: float = 0.0

    @property
    def success(self) -> bool:
        """Whether it did what it should; a mission that had nothing to do did."""
        return self.outcome in ("success", "skipped")

    def __str__(self) -> str:
        reason = f": {self.reason}" if self.reason else ""
        return f"the mission {_PHRASES[self.outcome]} after {self.seconds:.1f} s{reason}"


def report_of(task: Task, seconds: float) -> Report:
    """Of a task that is over."""
    if task.state is TaskState.COMPLETED and task.reason == NOTHING_TO_DO:
        return Report("skipped", "", seconds)
    return Report(_OUTCOMES.get(task.state, "stopped"), task.reason, seconds)

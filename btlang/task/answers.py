"""Tasks, schedules and missions as answers have them: as lines for people and as data for programs."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.task.task import MissionText, Revision, Schedule, Task
from btlang.text.escaping import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LONGEST = 60  # characters of a mission in a list
_HIDDEN = ("mission", "saved", "token")


def task_data(task: Task, waits: str = "") -> dict[str, Any]:
    """A task without its text, and why it waits."""
    data = {field: getattr(task, field) for field in task.fields if field not in _HIDDEN}
    return {**data, "mission": short(task.mission), "revision": task.mission.revision, "waits": waits}


def task_line(task: Mapping[str, Any]) -> str:
    """A task of `task_data` in one line: id, state, priority, mission, and why it waits or ended."""
    why = task["waits"] or task["reason"]
    priority = f" ({task['priority']:+d})" if task["priority"] else ""
    return f"{task['id']:>4}  {task['state']:<9}{priority}  {task['mission']}" + (f"  [{one_line(why)}]" if why else "")


def short(mission: MissionText) -> str:
    """The name of a mission or else its text, cut, in one line."""
    text = one_line(mission.name or " / ".join(line.strip() for line in mission.text.splitlines() if line.strip()))
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def schedule_data(schedule: Schedule) -> dict[str, Any]:
    """A schedule with the short form of its mission."""
    data = {field: getattr(schedule, field) for field in schedule.fields if field != "mission"}
    return {**data, "mission": short(schedule.mission)}


def revision_data(revision: Revision) -> dict[str, Any]:
    """A revision without its text."""
    return {field: getattr(revision, field) for field in revision.fields if field != "text"}

"""Tasks, schedules and missions as answers have them, and the report of some days in English."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import date, timedelta
from difflib import unified_diff
from itertools import takewhile

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, render
from btlang.task.commands.checks import refusal_error
from btlang.task.messages import Answer, Put
from btlang.task.schedule.calendar import format_duration, format_moment
from btlang.task.schedule.recurrence import read_rule
from btlang.task.store.records import FINAL, Act, MissionText, Revision, Schedule, Task, TaskState
from btlang.task.store.task_store import TaskStore
from btlang.text.formatting import joined, one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_LONGEST = 60  # characters of a mission in a list
_MOST_LINES = 3_000  # of texts whose smallest difference is found in some seconds, whatever they are
_HIDDEN = ("mission", "saved", "token")
_IN_QUOTES = ("text", "name", "rule", "reason")
_REFUSED = re.compile(r"(?:[^\n]*?: )?error (BT\d{3}): ([^\n]*)")
_TOKEN = re.compile(r" To let it go on, use the token \w+\.")


def task_data(task: Task, waits: str = "") -> dict[str, Any]:
    """Return a task without its text, and why it waits."""
    data = task.as_dict(without=_HIDDEN)
    return {**data, "mission": shorten(task.mission), "revision": task.mission.revision, "waits": waits}


def task_line(task: Mapping[str, Any]) -> str:
    """Return a task of `task_data` in one line: id, state, priority, mission, and why it waits or ended."""
    why = task["waits"] or task["reason"]
    priority = f"  (priority {task['priority']:+d})" if task["priority"] else ""
    return f"{task['id']:>4}  {task['state']:<9}  {task['mission']}{priority}" + (f"  [{one_line(why)}]" if why else "")


def shorten(mission: MissionText) -> str:
    """Return the name of a mission or else its text, cut, in one line."""
    return _cut(mission.title or mission.text)


def _cut(text: str, longest: int = _LONGEST) -> str:
    text = one_line(" / ".join(line.strip() for line in text.splitlines() if line.strip()))
    return text if len(text) <= longest else text[: longest - 3] + "..."


def act_line(act: Act, now: float) -> str:
    """Return an entry of the audit trail in one line: when, who, which command, and what came of it."""
    refused = _REFUSED.match(act.outcome)
    outcome = f"refused ({refused[1]}): {refused[2]}" if refused else _TOKEN.sub("", act.outcome.partition("\n\n")[0])
    what = ", ".join(_command_parts(json.loads(act.details)))
    by = one_line(act.person) or "nobody"
    return f"{format_moment(act.time, now)}  {by}: {act.command.replace('_', ' ')} {what}".rstrip() + (
        f"  [{_cut(outcome, 2 * _LONGEST)}]" if outcome else ""
    )


def _command_parts(fields: Mapping[str, Any]) -> Iterator[str]:
    """Yield the fields of a command in words, without its name and without what lets others do it."""
    for name, value in fields.items():
        is_named = name == "text" and fields.get("name")  # the name says enough
        if is_named or name in ("command", *_HIDDEN) or value in (None, "", [], {}):
            continue
        if isinstance(value, Mapping):
            value = " ".join(f"{key}={each}" for key, each in value.items())
        elif isinstance(value, list):
            value = " ".join(map(str, value))
        said = _cut(str(value))
        if name in _IN_QUOTES:
            said = f'"{said}"'
        yield said if name in _IN_QUOTES[:3] else f"{name} {said}"


def describe_times(earliest: float | None, deadline: float | None, now: float) -> Iterator[str]:
    """Say in sentences when a new task may begin: a clock time may be one of tomorrow."""
    if earliest is not None and earliest > now:
        yield f"It begins {_day_of(earliest, now)} at the earliest."
    if deadline is not None:
        yield f"It is skipped if it hasn't begun by {_day_of(deadline, now).removeprefix('at ').rstrip(',')}."


def _day_of(moment: float, now: float) -> str:
    written = format_moment(moment, now)
    there, today = (date.fromtimestamp(each) for each in (moment, now))
    return f"tomorrow, {written}," if there - today == timedelta(1) else f"at {written}"


def schedule_data(schedule: Schedule) -> dict[str, Any]:
    """Return a schedule with the short form of its mission, and its rule as data: `plan`."""
    rule = read_rule(schedule.rule).rule
    plan = {**rule.as_dict(), "days": rule.days.as_dict()}
    return {**schedule.as_dict(without=("mission",)), "mission": shorten(schedule.mission), "plan": plan}


def schedule_line(schedule: Schedule, now: float) -> str:
    """Return a schedule in one line: id, rule, mission, when it is due, and what isn't as usual."""
    zone = f" in {schedule.zone}" if schedule.zone else ""
    when = "" if schedule.next is None else f"; next at {format_moment(schedule.next, now)}"
    line = f"{schedule.id:>4}  {schedule.rule}{zone}: {shorten(schedule.mission)}{when}"
    unusual = [
        f"{field} {getattr(schedule, field)}"
        for field in ("overlap", "missed", "restart")
        if getattr(schedule, field) != schedule.field_defaults[field]
    ]
    unusual += [f"priority {schedule.priority:+d}"] if schedule.priority else []
    unusual += [] if schedule.within is None else [f"within {format_duration(schedule.within)}"]
    unusual += [f"label {one_line(label)}" for label in schedule.labels]
    unusual += [f"{one_line(name)}={one_line(str(value))}" for name, value in schedule.mission.values.items()]
    return f"{line}  [{', '.join(unusual)}]" if unusual else line


def revision_data(revision: Revision) -> dict[str, Any]:
    """Return a revision without its text."""
    return revision.as_dict(without=("text",))


def describe_deletion(name: str, schedules: Sequence[int]) -> str:
    """Return what is said of a text that is no longer in the library, while some schedules have it."""
    text = f"'{one_line(name)}' is no longer in the library."
    if not schedules:
        return text
    numbers = joined([str(number) for number in schedules])
    who, it = (f"Schedule {numbers} goes", "it") if len(schedules) == 1 else (f"Schedules {numbers} go", "them")
    return f"{text} {who} on with its text. To end {it}: btc task unschedule"


def outdated_error(command: Put, called: str, latest: Revision | None) -> Answer:
    """Return the refusal of a text, `called` "mission" or the like, that was made from another revision than the latest
    one, with what differs from that.
    """
    before = "" if latest is None else latest.text
    number = 0 if latest is None else latest.number
    problem = refusal_error(
        f"The {called} '{command.name}'", f"has changed since revision {command.revision}: it has {number}"
    )
    data = {"revision": number, "text": before, "diff": differences(before, command.text)}
    return Answer(False, str(problem), data, problem.diagnostics[0].code)


def differences(before: str, after: str) -> str:
    """Return a unified diff; of long texts with everything between the first and the last difference."""
    return "\n".join(_differences(before.splitlines(), after.splitlines()))


def _differences(before: list[str], after: list[str]) -> Iterable[str]:
    if max(len(before), len(after)) <= _MOST_LINES:
        return unified_diff(before, after, "latest", "yours", lineterm="")
    begin = _common(before, after)
    end = _common(before[begin:][::-1], after[begin:][::-1])
    old, new = before[begin : len(before) - end], after[begin : len(after) - end]
    place = f"@@ -{begin + 1},{len(old)} +{begin + 1},{len(new)} @@"
    return ["--- latest", "+++ yours", place, *(f"-{line}" for line in old), *(f"+{line}" for line in new)]


def _common(first: list[str], second: list[str]) -> int:
    """Return how many lines both begin with."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(first, second, strict=False)))


def write_report(store: TaskStore, since: float, until: float) -> Iterator[str]:
    """Write a report in lines for people.

    What counts is when a task was due, or else when it was asked for, in seconds since 1970.
    """
    tasks = [task for task in store.tasks() if since <= _time_of(task) < until]
    tasks.sort(key=lambda task: (_time_of(task), task.id))
    yield f"From {format_moment(since, 0.0)} to {format_moment(until, 0.0)}: {_count(tasks)}."
    schedules = {schedule.id: schedule for schedule in store.schedules()}
    for number in sorted({task.schedule for task in tasks if task.schedule}):
        group = [task for task in tasks if task.schedule == number]
        yield from _group(_title(group[0], schedules.get(number)), group)
    for person in sorted({task.person for task in tasks if not task.schedule}):
        group = [task for task in tasks if not task.schedule and task.person == person]
        yield from _group(f"{one_line(person) or 'Somebody'} asked", group, lists_all=True)


def _group(title: str, tasks: Sequence[Task], lists_all: bool = False) -> Iterator[str]:
    """List tasks; of those that a schedule makes again and again only the ones that weren't done."""
    yield ""
    yield f"{title}: {_count(tasks)}."
    for task in tasks:
        if lists_all or task.state is not TaskState.COMPLETED:
            reason = f": {one_line(task.reason)}" if task.reason else ""
            when = format_moment(_time_of(task), 0.0)
            yield f"  {when}  task {task.id}, {shorten(task.mission)}: {task.state}{reason}"


def _count(tasks: Sequence[Task]) -> str:
    done = sum(task.state is TaskState.COMPLETED for task in tasks)
    still_open = sum(task.state not in FINAL for task in tasks)
    rest = f", {still_open} not over yet" if still_open else ""
    return f"{done} of {len(tasks)} done{rest}"


def _title(task: Task, schedule: Schedule | None) -> str:
    rule = schedule.rule if schedule is not None else "a schedule that is removed"
    return f"{shorten(task.mission)} ({rule})"


def _time_of(task: Task) -> float:
    return task.created if task.due is None else task.due


_MOST_MESSAGES = 20


def refusal_data(error: MissionError) -> dict[str, Any]:
    """Return the data of a refusal: its `messages`."""
    return messages_data(error.diagnostics)


def messages_data(problems: Sequence[Diagnostic]) -> dict[str, Any]:
    """Return `messages`, each with `code`, `message`, `hint` and `line` (0: of no text); nothing for none."""
    found = [
        {
            "code": problem.code, "message": problem.message, "hint": problem.hint,
            "line": problem.span.source.position(problem.span.start)[0] if problem.span.source.text else 0,
        }
        for problem in problems[:_MOST_MESSAGES]
    ]  # fmt: skip
    return {"messages": found} if found else {}


def with_warnings(text: str, warnings: Sequence[Diagnostic]) -> str:
    """Add what a mission that was taken is warned of, so that whoever gave it can still take it back."""
    return "\n\n".join([text, *(render(problem) for problem in warnings[:_MOST_MESSAGES])])

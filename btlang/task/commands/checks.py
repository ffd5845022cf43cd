"""Checks of what a command brings, and the refusals of the message handler."""

from __future__ import annotations

import re
from collections.abc import Iterable

from btlang.api import Mission, value_key
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.task.messages import Submit, wrong
from btlang.task.schedule.calendar import format_moment
from btlang.task.schedule.recurrence import read_moment, read_past_moment
from btlang.task.store.records import PRIORITIES
from btlang.text.formatting import one_line
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from enum import StrEnum
    from typing import TypeVar

    Choice = TypeVar("Choice", bound=StrEnum)

HIGHEST = 2**63 - 1
"""The highest number that a store can ask for."""
_WEEK = 7 * 86_400.0


def read_time(given: str | float | None, now: float) -> float | None:
    """Return a time since 1970, given as one or in English. Raises MissionError (BT194)."""
    return read_moment(given, now) if isinstance(given, str) else given


def report_times(since: str | float | None, until: str | float | None, now: float) -> tuple[float, float]:
    """Return when a report begins and ends: English is about the past there. Raises MissionError (BT194, BT187)."""
    end = read_past_moment(until, now) if isinstance(until, str) else now if until is None else until
    begin = read_past_moment(since, now) if isinstance(since, str) else end - _WEEK if since is None else since
    if begin > end:
        raise refusal_error(
            "The report", f"would begin at {format_moment(begin, now)}, after its end at {format_moment(end, now)}"
        )
    return begin, end


def task_times(command: Submit, now: float) -> tuple[float | None, float | None]:
    """Return when its task may begin at the earliest and at the latest.

    Raises MissionError (BT194; BT187 if it never may).
    """
    earliest, deadline = read_time(command.at, now), read_time(command.by, now)
    if deadline is not None and deadline <= now:
        raise refusal_error("The task", f"could never begin: its deadline, {format_moment(deadline, now)}, has passed")
    if earliest is not None and deadline is not None and earliest > deadline:
        times = (
            f"its earliest time, {format_moment(earliest, now)}, is after its deadline, {format_moment(deadline, now)}"
        )
        raise refusal_error("The task", f"could never begin: {times}")
    return earliest, deadline


def check_values(mission: Mission, names: Iterable[str]) -> None:
    """Raise MissionError (BT187) if a mission doesn't speak of the value with one of these names."""
    ports = "\n".join(f"{port} {text}" for node in mission.tree.walk() for port, text in node.ports)
    words = set(re.findall(r"\w+", ports))
    for name in names:
        if not set(re.findall(r"\w+", value_key(name))) <= words:
            raise refusal_error("The mission", f"has no value '{one_line(name)}'")


def check_labels(labels: tuple[str, ...], command: str) -> tuple[str, ...]:
    """Return the labels. Raises MissionError (BT198) if one is empty."""
    if not all(label.strip() for label in labels):
        raise wrong(command, "a label must have a text")
    return labels


def check_priority(priority: int, command: str) -> int:
    """Return the priority. Raises MissionError (BT198) if it is out of range."""
    least, most = PRIORITIES
    if not least <= priority <= most:
        raise wrong(command, f"'priority' must be from {least} to {most}")
    return priority


def check_within(seconds: float | None) -> float | None:
    """Return the time after which a task of a schedule isn't worth beginning.

    Raises MissionError (BT198) if it isn't one.
    """
    if seconds is not None and seconds <= 0:
        raise wrong("schedule", "'within' must be more than 0")
    return seconds


def choose_member(kind: type[Choice], given: str, field: str, command: str) -> Choice:
    """Return the member of a kind that a field of a command names. Raises MissionError (BT198)."""
    try:
        return kind(given)
    except ValueError:
        names = ", ".join(f"'{each}'" for each in kind)
        raise wrong(command, f"'{field}' must be one of {names}, not '{given}'") from None


def refusal_error(what: int | str, reason: str) -> MissionError:
    """Make the error BT187: what a command is about can't be changed like that.

    `what` begins a sentence; a number is a task's.
    """
    named = f"Task {what}" if isinstance(what, int) else what
    return MissionError([diagnostic("BT187", NOWHERE, what=named, reason=reason)])

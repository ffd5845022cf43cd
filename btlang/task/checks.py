"""Checks of what a command brings, and the refusals of the message handler."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.task.messages import wrong
from btlang.task.moments import shown
from btlang.task.recurrence import read_moment, read_past_moment
from btlang.task.task import PRIORITIES
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from enum import StrEnum
    from typing import TypeVar

    Choice = TypeVar("Choice", bound=StrEnum)

_WEEK = 7 * 86_400.0


def moment(given: str | float | None, now: float) -> float | None:
    """A time since 1970, given as one or in English. Raises MissionError (BT194)."""
    return read_moment(given, now) if isinstance(given, str) else given


def report_times(since: str | float | None, until: str | float | None, now: float) -> tuple[float, float]:
    """When a report begins and ends: English is about the past there. Raises MissionError (BT194, BT187)."""
    end = read_past_moment(until, now) if isinstance(until, str) else now if until is None else until
    begin = read_past_moment(since, now) if isinstance(since, str) else end - _WEEK if since is None else since
    if begin > end:
        raise refused("The report", f"would begin at {shown(begin, now)}, after its end at {shown(end, now)}")
    return begin, end


def checked_priority(priority: int) -> int:
    """The priority. Raises MissionError (BT198) if it is out of range."""
    least, most = PRIORITIES
    if not least <= priority <= most:
        raise wrong("submit", f"'priority' must be from {least} to {most}")
    return priority


def choice(kind: type[Choice], given: str, field: str) -> Choice:
    """The member of a kind that a text names. Raises MissionError (BT198)."""
    try:
        return kind(given)
    except ValueError:
        names = ", ".join(f"'{each}'" for each in kind)
        raise wrong(field, f"'{given}' isn't one of {names}") from None


def refused(what: int | str, reason: str) -> MissionError:
    """BT187: what a command is about can't be changed like that. `what` begins a sentence; a number is a task's."""
    named = f"Task {what}" if isinstance(what, int) else what
    return MissionError([diagnostic("BT187", NOWHERE, what=named, reason=reason)])

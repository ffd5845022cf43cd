"""What commands about schedules do: a part of the message handler."""

from __future__ import annotations

from collections.abc import Callable

from btlang.task import messages
from btlang.task.answers import schedule_data, schedule_line
from btlang.task.checks import HIGHEST, checked_labels, checked_priority, checked_within, choice, refused
from btlang.task.messages import Answer
from btlang.task.moments import shown
from btlang.task.recurrence import read_rule
from btlang.task.store import Store
from btlang.task.task import Missed, MissionText, Overlap, Restart, Schedule


class ScheduleHandler:
    """Its methods are those of btlang.task.handler.Handler; `wake` lets the executor look again, and `mission_of` gives
    the mission of a command, which the robot can do (MissionError).
    """

    def __init__(
        self,
        store: Store,
        wake: Callable[[], object],
        mission_of: Callable[[messages.AddSchedule], MissionText],
        now: Callable[[], float],
    ) -> None:
        self._store, self._wake, self._mission_of, self._now = store, wake, mission_of, now

    def add(self, command: messages.AddSchedule, person: str) -> Answer:
        """A new one."""
        recurrence, now = read_rule(command.rule, command.zone), self._now()
        mission = self._mission_of(command)
        first = recurrence.next(now)
        if first is None:
            raise refused(f"The schedule '{recurrence}'", "would never be due: its time has passed")
        made = self._store.add_schedule(
            Schedule(
                0, str(recurrence), command.zone, mission, person, now, first,
                checked_priority(command.priority, command.tag), checked_labels(command.labels, command.tag),
                choice(Restart, command.restart, "restart", command.tag),
                choice(Overlap, command.overlap, "overlap", command.tag),
                choice(Missed, command.missed, "missed", command.tag), checked_within(command.within),
            )
        )  # fmt: skip
        self._wake()
        text = f"Schedule {made.id}: {made.rule}; next at {shown(first, now)}."
        return Answer(True, text, {"schedule": schedule_data(made)})

    def remove(self, command: messages.RemoveSchedule, person: str) -> Answer:
        """Ends one."""
        if command.schedule > HIGHEST or not self._store.delete_schedule(command.schedule):
            raise refused(f"Schedule {command.schedule}", "isn't known")
        return Answer(True, f"Schedule {command.schedule} is removed.", {})

    def list(self, command: messages.Schedules, person: str) -> Answer:
        """All of them."""
        now, found = self._now(), self._store.schedules()
        lines = [schedule_line(each, now) for each in found]
        text = "\n".join(lines) or "There are no schedules."
        return Answer(True, text, {"schedules": [schedule_data(each) for each in found]})

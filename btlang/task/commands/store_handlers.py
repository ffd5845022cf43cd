"""Handlers of commands about the library and schedules."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from shlex import quote

from btlang.api import Mission
from btlang.robots.bodies.body_file import read_body
from btlang.robots.worlds.world_file import read_world
from btlang.task import messages
from btlang.task.commands.answers import (
    describe_deletion,
    messages_data,
    outdated_error,
    revision_data,
    schedule_data,
    schedule_line,
    with_warnings,
)
from btlang.task.commands.checks import (
    HIGHEST,
    check_labels,
    check_priority,
    check_within,
    choose_member,
    refusal_error,
)
from btlang.task.messages import Answer, wrong
from btlang.task.schedule.calendar import format_moment
from btlang.task.schedule.recurrence import read_rule
from btlang.task.store.records import LibraryKind, Missed, MissionText, Overlap, Restart, Schedule
from btlang.task.store.task_store import TaskStore
from btlang.text.formatting import one_line
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.diagnostics.diagnostic import Diagnostic, MissionError
    from btlang.robots.bodies.body import Body
    from btlang.task.store.records import Revision

Warned: TypeAlias = "tuple[MissionText, Sequence[Diagnostic]]"
"""A mission that the robot takes, and what it is warned of."""
MOST_CHARACTERS = 200_000
"""The limit of a text from others that isn't a mission; a world or robot file takes some seconds to read at most."""
_LONGEST_NAME = 200
_CALLED = {
    LibraryKind.MISSION: "mission",
    LibraryKind.WORLD: "world",
    LibraryKind.ROBOT: "robot file",
    LibraryKind.TEST: "test file",
}


class LibraryHandler:
    """A handler of commands about the library, with methods like those of Handler (handler.py).

    `admit` reads a mission as it does there. Worlds must leave room for `body`, if it's known. Robot files may name
    nothing but one of `overs` to run on. Tests aren't read: they may be written before the mission that they run.
    """

    def __init__(
        self,
        store: TaskStore,
        admit: Callable[[MissionText], Mission],
        now: Callable[[], float],
        body: Body | None,
        overs: Collection[str],
    ) -> None:
        self._store, self._admit, self._now, self._body, self._overs = store, admit, now, body, overs

    def put(self, command: messages.Put, person: str) -> Answer:
        """Keep a new revision of a text that the robot can use."""
        name, kind = command.name, choose_member(LibraryKind, command.kind, "kind", command.tag)
        if not name.strip() or "/" in name or not name.isprintable() or len(name) > _LONGEST_NAME:
            reason = f"a name of at most {_LONGEST_NAME} characters, without '/', that can be shown"
            raise wrong(command.tag, f"'name' must be {reason}")
        if name in (".", ".."):  # browsers leave them out of addresses
            raise wrong(command.tag, "'name' must not be '.' or '..'")
        self._check(kind, name, command.text)
        kept = self._store.put_text(name, command.text, person, self._now(), command.revision, kind)
        if kept is None:
            return outdated_error(command, _CALLED[kind], self._store.text(name, kind=kind))
        text = f"'{one_line(kept.name)}' is in the library, revision {kept.number}."
        return Answer(True, text, {kind: revision_data(kept)})

    def delete(self, command: messages.Delete, person: str) -> Answer:
        """Take a text out of the library."""
        kind = choose_member(LibraryKind, command.kind, "kind", command.tag)
        if not self._store.delete_text(command.name, person, self._now(), kind):
            raise unknown_text_error(command.name, kind)
        missions = [] if kind is not LibraryKind.MISSION else self._store.schedules()
        left = [each.id for each in missions if each.mission.revision and each.mission.name == command.name]
        return Answer(True, describe_deletion(command.name, left), {"schedules": left})

    def list(self, command: messages.Library, person: str) -> Answer:
        """List all texts of a kind, or what there is of one."""
        kind = choose_member(LibraryKind, command.kind, "kind", command.tag)
        found = self._find(command, kind)
        now = self._now()
        lines = [
            f"{one_line(each.name)}, revision {each.number}: {one_line(each.person)}, {format_moment(each.time, now)}"
            + (", deleted" if each.deleted else "")
            for each in found
        ]
        data = [{**revision_data(each), "text": each.text} for each in found]
        if command.name and not found:
            raise unknown_text_error(command.name, kind)
        empty = "The library is empty." if kind is LibraryKind.MISSION else f"The library has no {_CALLED[kind]}s."
        return Answer(True, "\n".join(lines) or empty, {f"{kind}s": data})

    def _find(self, command: messages.Library, kind: LibraryKind) -> Sequence[Revision]:
        if not command.name:
            return self._store.texts(kind)
        if command.revision is None:
            return self._store.revisions(command.name, kind)
        found = self._store.text(command.name, command.revision, kind) if command.revision <= HIGHEST else None
        return [] if found is None else [found]

    def _check(self, kind: LibraryKind, name: str, text: str) -> None:
        """Raise MissionError with what is wrong with a text. Reads only the text, and runs nothing."""
        if kind is LibraryKind.MISSION:
            self._admit(MissionText(text, name))
            return
        if len(text) > MOST_CHARACTERS:
            raise wrong("put", f"a {_CALLED[kind]} may have at most {MOST_CHARACTERS:,} characters")
        if kind is LibraryKind.TEST:
            return
        source = Source(text, one_line(name), roots=())
        if kind is LibraryKind.ROBOT:
            read_body(source, self._overs)
            return
        read_world(source, self._body)


def latest_text(store: TaskStore, name: str, kind: LibraryKind) -> Source:
    """Return the newest revision of a world or robot file. Raises MissionError (BT187) if there's none."""
    found = store.text(name, kind=kind)
    if found is None:
        raise unknown_text_error(name, kind)
    return Source(found.text, one_line(name), roots=())


def unknown_text_error(name: str, kind: LibraryKind = LibraryKind.MISSION) -> MissionError:
    """Make the error BT187: there's no such text."""
    of_kind = "" if kind is LibraryKind.MISSION else f" --kind {kind.value}"
    error = refusal_error(f"The {_CALLED[kind]} '{name}'", "isn't in the library")
    return error.advising(f"To put it there: btc task put {quote(one_line(name))} FILE{of_kind}")


class ScheduleHandler:
    """A handler of commands about schedules, with methods like those of Handler (handler.py).

    `wake` lets the executor look again. `mission_of` reads the mission of a command, and raises MissionError if the
    robot can't do it.
    """

    def __init__(
        self,
        store: TaskStore,
        wake: Callable[[], object],
        mission_of: Callable[[messages.AddSchedule], Warned],
        now: Callable[[], float],
    ) -> None:
        self._store, self._wake, self._mission_of, self._now = store, wake, mission_of, now

    def add(self, command: messages.AddSchedule, person: str) -> Answer:
        """Add a schedule."""
        recurrence, now = read_rule(command.rule, command.zone), self._now()
        mission, warnings = self._mission_of(command)
        first = recurrence.next(now)
        if first is None:
            raise refusal_error(f"The schedule '{recurrence}'", "would never be due: its time has passed")
        made = self._store.add_schedule(
            Schedule(
                0, str(recurrence), command.zone, mission, person, now, first,
                check_priority(command.priority, command.tag), check_labels(command.labels, command.tag),
                choose_member(Restart, command.restart, "restart", command.tag),
                choose_member(Overlap, command.overlap, "overlap", command.tag),
                choose_member(Missed, command.missed, "missed", command.tag), check_within(command.within),
            )
        )  # fmt: skip
        self._wake()
        text = f"Schedule {made.id}: {made.rule}; next at {format_moment(first, now)}."
        data = {"schedule": schedule_data(made), **messages_data(warnings)}
        return Answer(True, with_warnings(text, warnings), data)

    def remove(self, command: messages.RemoveSchedule, person: str) -> Answer:
        """Remove a schedule."""
        if command.schedule > HIGHEST or not self._store.delete_schedule(command.schedule):
            raise refusal_error(f"Schedule {command.schedule}", "isn't known")
        return Answer(True, f"Schedule {command.schedule} is removed.", {})

    def list(self, command: messages.Schedules, person: str) -> Answer:
        """List all schedules."""
        now, found = self._now(), self._store.schedules()
        lines = [schedule_line(each, now) for each in found]
        text = "\n".join(lines) or "There are no schedules."
        return Answer(True, text, {"schedules": [schedule_data(each) for each in found]})

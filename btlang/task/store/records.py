"""The records of a store: tasks, missions that a robot is to do with their states, and what else is kept."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from enum import StrEnum

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MAIN_TREE = re.compile(r"""\b(?:main_tree_to_execute|BehaviorTree\s+ID)=(["'])(.*?)\1""")


def is_storable(value: Any) -> bool:
    """Return whether stores, files and messages take all texts and numbers in a value."""
    waiting = [value]
    while waiting:
        each = waiting.pop()
        if isinstance(each, dict):
            waiting += [*each.keys(), *each.values()]
        elif isinstance(each, list | tuple):
            waiting += each
        elif (isinstance(each, float) and not math.isfinite(each)) or (isinstance(each, str) and not is_whole(each)):
            return False
    return True


def is_whole(text: str) -> bool:
    """Return whether a text has no NUL and no half of a character."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return "\0" not in text


class TaskState(StrEnum):
    """A state of a task; the names are those of Open-RMF (rmf_api_msgs, task_state.json)."""

    QUEUED = "queued"
    """Waits for its turn or its time."""
    STANDBY = "standby"
    """Is the next one: the robot gets ready for it."""
    UNDERWAY = "underway"
    DELAYED = "delayed"
    """Interrupted by a person or a more urgent task; it goes on later."""
    BLOCKED = "blocked"
    """Can't begin or go on until something else is put right, which its reason says."""
    SKIPPED = "skipped"
    """Wasn't begun, on purpose: a person or the rules of its schedule said so."""
    CANCELED = "canceled"
    """Ended by a person, as the mission's halt says."""
    KILLED = "killed"
    """Ended by a person or an emergency stop, at once."""
    FAILED = "failed"
    """The mission failed."""
    ERROR = "error"
    """It couldn't run to an end of its own: the robot was cut off, say."""
    COMPLETED = "completed"


FINAL = frozenset(
    (TaskState.SKIPPED, TaskState.CANCELED, TaskState.KILLED, TaskState.FAILED, TaskState.ERROR, TaskState.COMPLETED)
)
"""A task in one of these never changes again."""
WAITING = frozenset((TaskState.QUEUED, TaskState.DELAYED, TaskState.BLOCKED))
"""A task in one of these may still begin or go on."""
ACTIVE = frozenset((TaskState.STANDBY, TaskState.UNDERWAY))
"""The executor has it; at most one task of a robot is in one of these."""


class Restart(StrEnum):
    """A rule for a task that was under way when the robot's process ended."""

    GIVE_UP = "give up"
    AGAIN = "again"
    RESUME = "resume"


class Overlap(StrEnum):
    """A rule for a schedule whose time comes while its task before isn't over."""

    SKIP = "skip"
    QUEUE = "queue"
    REPLACE = "replace"


class Missed(StrEnum):
    """A rule for the times of a schedule that passed while the robot was down."""

    SKIP = "skip"
    ONCE = "once"
    ALL = "all"


PRIORITIES = -100, 100
"""The least and the most urgent."""


class MissionText(Record):
    """A mission as it was submitted. `name` is that of its file, or in the library if `revision` isn't 0. `values` are
    the first values of its blackboard, by name: its parameters. `keywords` are further keyword files. `file` is the
    path of a file that the robot's owner named, which is read instead of the text, as it is then.
    """

    text: str
    name: str = ""
    revision: int = 0
    values: Mapping[str, Any] = {}
    keywords: tuple[str, ...] = ()
    file: str = ""

    @property
    def title(self) -> str:
        """The name, of a nameless tree in XML that of its main tree; "" if it has none."""
        found = _MAIN_TREE.search(self.text) if not self.name and self.text.lstrip()[:1] == "<" else None
        return self.name if found is None else found[2]


class Task(Record):
    """A mission that the robot is to do. Times are in seconds since 1970, None if there is none.

    `id` is positive and unique in its store, 0 before it is in one. Higher `priority` comes first, then lower
    `position`, then the lower id; who waits for long gets a `bonus` to its priority. It isn't begun before
    `earliest`, and not after `deadline`. `needs` are capabilities of the robot. `schedule` is the id of the
    schedule that made it (0: none) for the time `due`. `reason` says why it waits, or how it ended. `saved` is the
    JSON of its run when it was interrupted or saved last, "" for a fresh start; `token` is what the command to
    resume it must bring, "" where nobody interrupted it. `recording` is a path.
    """

    id: int
    mission: MissionText
    person: str
    created: float
    state: TaskState = TaskState.QUEUED
    priority: int = 0
    labels: tuple[str, ...] = ()
    earliest: float | None = None
    deadline: float | None = None
    restart: Restart = Restart.GIVE_UP
    needs: tuple[str, ...] = ()
    schedule: int = 0
    due: float | None = None
    position: int = 0
    attempts: int = 0
    started: float | None = None
    ended: float | None = None
    reason: str = ""
    saved: str = ""
    token: str = ""
    recording: str = ""
    bonus: int = 0


class RequestedEnd(Record):
    """A request to end the run under way: the state that its task gets then, why, by whom, and the token."""

    state: TaskState
    cause: str
    person: str
    token: str = ""

    def outranks(self, other: RequestedEnd) -> bool:
        """Return whether it replaces one that was asked for a moment before.

        Whoever asked for that was promised it, so only more replaces it: a token after a suspension without one, the
        end after that, and a kill after another end.
        """
        return self._rank > other._rank

    @property
    def _rank(self) -> tuple[bool, bool, bool]:
        return self.state is TaskState.KILLED, self.state in FINAL, bool(self.token)


class TaskChange(Record):
    """A task got a state: when, why, and through whom ("" for the robot itself)."""

    task: int
    time: float
    state: TaskState
    cause: str
    person: str


class Schedule(Record):
    """A mission for certain times. `rule` is English (see recurrence.py) in the time zone `zone`, "" for that of the
    computer. `next` is when it is due, None if it never is again. Its tasks get the other fields.
    """

    id: int
    rule: str
    zone: str
    mission: MissionText
    person: str
    created: float
    next: float | None
    priority: int = 0
    labels: tuple[str, ...] = ()
    restart: Restart = Restart.GIVE_UP
    overlap: Overlap = Overlap.SKIP
    missed: Missed = Missed.SKIP
    within: float | None = None
    """Seconds after the time when a task that has not begun is not worth beginning; None: always worth it."""


class LibraryKind(StrEnum):
    """A kind of text in the library: a mission, a world file, a robot file, or the tests of a mission, which have its
    name. Each kind has names of its own.
    """

    MISSION = "mission"
    WORLD = "world"
    ROBOT = "robot"
    TEST = "test"


class Revision(Record):
    """One revision of a text in the library; the first has number 1. One with `deleted` has no text."""

    name: str
    number: int
    text: str
    person: str
    time: float
    deleted: bool = False
    kind: LibraryKind = LibraryKind.MISSION


class Act(Record):
    """An entry of the audit trail: who asked for what, and what came of it."""

    time: float
    person: str
    command: str
    details: str
    outcome: str

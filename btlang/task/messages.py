"""What may be asked of a robot: a class for each command. The CLI, the library, ROS 2 and servers all send these.

As JSON a command is an object with its name under "command" and its fields; `commands/schema.py` describes them all.
"""

from __future__ import annotations

from collections.abc import Mapping

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.support.field_types import field_type
from btlang.support.record import Record
from btlang.task.store.records import LibraryKind, Missed, Overlap, Restart, is_storable
from btlang.text.source import NOWHERE
from btlang.text.spelling import nearest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, ClassVar


class Command(Record):
    """What somebody wants the robot, or its task layer, to do. `tag` is its name."""

    tag: ClassVar[str] = ""
    changes: ClassVar[bool] = True
    """Whether it may change anything: such commands are in the audit trail."""


class Submit(Command):
    """A mission to do: a text, or the name of one in the library. `keywords` are keyword files that it needs; the robot
    must allow them. `at` and `by` are when it may begin at the earliest and at the latest: seconds since 1970, or
    English such as "14:30" or "in 10 minutes".
    """

    tag = "submit"
    text: str = ""
    name: str = ""
    values: Mapping[str, Any] = {}
    keywords: tuple[str, ...] = ()
    priority: int = 0
    labels: tuple[str, ...] = ()
    at: str | float | None = None
    by: str | float | None = None
    restart: str = Restart.GIVE_UP


class List(Command):
    """The tasks that are not over, in the order of their turn; or those in these `states`, newest first. The answer has
    at most `limit` of them (None: all), and says how many `more` there are.
    """

    tag = "list"
    changes = False
    states: tuple[str, ...] = ()
    label: str = ""
    limit: int | None = 100


class Show(Command):
    """All that is known of a task."""

    tag = "show"
    changes = False
    task: int


class Cancel(Command):
    """Ends a task; a mission under way is halted as it says itself (what cleans up after it runs)."""

    tag = "cancel"
    task: int
    reason: str = ""


class Kill(Command):
    """Ends a task at once; nothing cleans up after its mission."""

    tag = "kill"
    task: int
    reason: str = ""


class Interrupt(Command):
    """Halts a mission, which can go on later: the answer has the token that `resume` needs."""

    tag = "interrupt"
    task: int
    reason: str = ""


class Resume(Command):
    """Lets an interrupted task go on. Without a task: ends a pause, or what keeps all tasks waiting, if it's over."""

    tag = "resume"
    task: int = 0
    token: str = ""


class Skip(Command):
    """A task that hasn't begun is left out."""

    tag = "skip"
    task: int
    reason: str = ""


class Reorder(Command):
    """A task that waits gets another priority, or comes right before another task (and gets its priority)."""

    tag = "reorder"
    task: int
    priority: int | None = None
    before: int = 0


class Again(Command):
    """A new task like an earlier one."""

    tag = "again"
    task: int


class AddSchedule(Command):
    """A mission for certain times: `rule` is English, such as "every day at 9:00", in the time zone `zone`."""

    tag = "schedule"
    rule: str
    text: str = ""
    name: str = ""
    zone: str = ""
    values: Mapping[str, Any] = {}
    keywords: tuple[str, ...] = ()
    priority: int = 0
    labels: tuple[str, ...] = ()
    restart: str = Restart.GIVE_UP
    overlap: str = Overlap.SKIP
    missed: str = Missed.SKIP
    within: float | None = None


class RemoveSchedule(Command):
    """Ends a schedule; tasks that it has made stay."""

    tag = "unschedule"
    schedule: int


class Schedules(Command):
    """All schedules, with the time when each is due next."""

    tag = "schedules"
    changes = False


class Put(Command):
    """Keeps a text in the library under a name, which is unique in its `kind`: "mission", "world", "robot", or "test"
    for the tests of the mission with this name. Every earlier revision stays. With the `revision` that the text was
    made from, 0 for a new one, it is refused if there is another one by now: the answer has the `diff` to that.
    """

    tag = "put"
    name: str
    text: str
    revision: int | None = None
    kind: str = LibraryKind.MISSION.value


class Delete(Command):
    """Takes a text out of the library; its revisions stay, and tasks and schedules that have its text still run.
    The answer has the numbers of these `schedules`.
    """

    tag = "delete"
    name: str
    kind: str = LibraryKind.MISSION.value


class Library(Command):
    """The missions of the library, or its texts of another `kind`; with a `name` the revisions of that one, or only the
    one with the number `revision`, 0 for the latest.
    """

    tag = "library"
    changes = False
    name: str = ""
    kind: str = LibraryKind.MISSION.value
    revision: int | None = None


class Pause(Command):
    """The robot comes to rest, and the mission under way waits; no other one begins."""

    tag = "pause"


class Step(Command):
    """In a pause: the mission goes on by one tick."""

    tag = "step"


class EmergencyStop(Command):
    """Stops the robot at once. Nothing moves it before `release`."""

    tag = "emergency_stop"
    reason: str = ""


class Release(Command):
    """Opens the latch of the emergency stop; the mission that it ended doesn't go on."""

    tag = "release"


class Say(Command):
    """The robot says a text now, whatever it does meanwhile."""

    tag = "say"
    text: str


class AnswerQuestion(Command):
    """The robot hears this text after its question. Refused if it isn't asking anything. At most 500 characters."""

    tag = "answer"
    text: str


class Talk(Command):
    """Somebody holds a button while they speak to the robot's microphone, or lets go of it: `act` is "hold" or
    "release". To be sent again each second while it is held: 2 s after the last one the robot listens no more. Refused
    if its ears have no "push", or no microphone.
    """

    tag = "talk"
    changes = False  # what is heard is in the recording; the audit trail needn't have it each second
    act: str


class InviteVisitor(Command):
    """Somebody comes to the robot, which must be in a simulated world: the next one who is to come, else a guest."""

    tag = "visitor"


class Down(Command):
    """The robot's process ends, as after SIGTERM."""

    tag = "down"


class Status(Command):
    """What the robot does now, and what keeps it from doing more."""

    tag = "status"
    changes = False


class Components(Command):
    """The components and devices of the robot, with their states."""

    tag = "components"
    changes = False


class Picture(Command):
    """What a camera sees now: the answer has it as a PNG in base64, at most 320 pixels wide."""

    tag = "picture"
    changes = False
    device: str


class Voice(Command):
    """What the robot says now, or said last: the answer has up to half a minute of it as WAV in base64, and how many
    seconds of it are over. Refused if it has a speaker, or no voice that can be heard.
    """

    tag = "voice"
    changes = False


class Urdf(Command):
    """The body of the robot as URDF, the form of ROS 2. Refused if its joints have no links."""

    tag = "urdf"
    changes = False


class ChangeComponent(Command):
    """Starts a component anew ("restart"), takes it from the robot file as that is by now ("load"), or out of the robot
    ("unload"): at once, or as soon as no running mission uses it.
    """

    tag = "change_component"
    name: str
    act: str


class Report(Command):
    """What the robot did from `since` to `until`: seconds since 1970, or English for the past such as "2 hours ago"; by
    default in the last seven days.
    """

    tag = "report"
    changes = False
    since: str | float | None = None
    until: str | float | None = None


class Trail(Command):
    """The audit trail: the latest commands, and who gave them."""

    tag = "trail"
    changes = False
    limit: int = 50


COMMANDS: dict[str, type[Command]] = {
    kind.tag: kind
    for kind in (
        Submit, List, Show, Cancel, Kill, Interrupt, Resume, Skip, Reorder, Again, AddSchedule, RemoveSchedule,
        Schedules, Put, Delete, Library, Pause, Step, EmergencyStop, Release, Say, AnswerQuestion, Talk,
        InviteVisitor, Down, Status, Report, Trail, Components, ChangeComponent, Picture, Voice, Urdf,
    )
}  # fmt: skip
"""The classes of commands by their names."""


class Answer(Record):
    """What became of a command: `text` says it to people, `data` has it for programs. If it was refused, `code` is that
    of the diagnostic (see docs/messages.md), and `text` says why and what to do.
    """

    ok: bool
    text: str
    data: Mapping[str, Any] = {}
    code: str = ""

    def as_json(self) -> dict[str, Any]:
        """Return its fields."""
        return {"ok": self.ok, "text": self.text, "data": dict(self.data), "code": self.code}


MOST_REASON = 500
"""The characters of a reason that are kept; every answer about the state of a robot has them."""


def read_command(data: object) -> Command:
    """Read a command from its JSON. Raises MissionError (BT198) if it isn't one."""
    if not isinstance(data, dict):
        raise wrong("", "it must be an object")
    name = data.get("command")
    kind = COMMANDS.get(name) if isinstance(name, str) else None
    if kind is None:
        similar = nearest(str(name), COMMANDS, 1)
        raise wrong(str(name), "there's no such command" + (f"; did you mean '{similar[0]}'?" if similar else ""))
    given: dict[str, Any] = {}
    for field, value in data.items():
        if field == "command":
            continue
        if field not in kind.fields:
            raise wrong(kind.tag, f"it has no field '{field}'")
        given[field] = _check_field(kind, field, value)
        if field == "reason":  # an emergency stop isn't refused because somebody has much to say
            given[field] = given[field][:MOST_REASON]
    missing = [field for field in kind.fields if field not in given and field not in kind.field_defaults]
    if missing:
        raise wrong(kind.tag, f"the field '{missing[0]}' is missing")
    return kind(**given)


def as_json(command: Command) -> dict[str, Any]:
    """Write a command as `read_command` takes it, without the fields that have their defaults."""
    written: dict[str, Any] = {"command": command.tag}
    for field in command.fields:
        value = getattr(command, field)
        if field not in command.field_defaults or value != command.field_defaults[field]:
            written[field] = list(value) if isinstance(value, tuple) else value
    return written


def _check_field(kind: type[Command], field: str, value: Any) -> Any:
    annotation = kind.__annotations__[field]
    expected, described = field_type(annotation)
    texts = annotation == "tuple[str, ...]"
    if annotation in ("int", "int | None") and isinstance(value, float) and value.is_integer():
        value = int(value)  # JSON knows one kind of number
    fits = isinstance(value, expected) and not isinstance(value, bool)
    if not fits or (texts and not all(isinstance(each, str) for each in value)) or value != value:
        raise wrong(kind.tag, f"'{field}' must be of the type {described['type']}")
    if not is_storable(value):
        raise wrong(kind.tag, f"'{field}' has a NUL or half a character (a lone surrogate), or a number without end")
    return tuple(value) if texts else value


def wrong(name: str, reason: str) -> MissionError:
    """Make the error BT198: a command, or a part of it, isn't as it must be."""
    return MissionError([diagnostic("BT198", NOWHERE, name=name, reason=reason)])

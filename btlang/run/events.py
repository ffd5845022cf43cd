"""Everything that happens while a mission runs: a class for each kind. The JSON log and its schema use them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from time import time

from btlang.engine.status import FAILURE, IDLE, NAMES, SUCCESS
from btlang.support.record import Record
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, ClassVar, Protocol, TypeAlias

    from btlang.engine.changes import Changes
    from btlang.engine.instance import Fault, NodeInstance
    from btlang.run.robot_state import RobotState

    Sink: TypeAlias = Callable[["Event"], object]

    class Nodes(Protocol):
        """The nodes of a tree by their numbers; see btlang.engine.engine.Engine."""

        @property
        def size(self) -> int: ...

        def path(self, index: int) -> str: ...

        def node(self, index: int) -> Node: ...

        def filled(self, index: int) -> Node: ...

        def reason(self, index: int, fault: Fault | NodeInstance | None) -> str: ...

    class Robot(Protocol):
        """The part of a robot that a run needs; see btlang.robots.robot.Robot.

        `moving`, `standstill`, `disable` and `enable` may be missing, and so may `moves_by_itself`, which is then
        assumed to be true.

        `moves_by_itself` is False for a simulated robot: its world stands still between two steps.
        """

        def step(self, dt: float) -> object: ...

        def stop(self) -> object: ...


_FIELD = re.compile(r"\[([^\]]*)\]|\{(\w+):?([^}]*)\}")
_NAME = re.compile(r"\{(\w+)")


class Event(Record):
    """The fields of all events: `t` in seconds of mission time, `run` the id of the run, `number` from 0 on without
    gaps in a run, and `wall` in seconds since 1970.
    """

    tag: ClassVar[str] = ""
    """The name of its class in logs; "" for a change of status."""
    alarms: ClassVar[bool] = False
    """Whether something is wrong: the page says so in another colour."""
    line: ClassVar[str] = ""
    """The line that people read of it, a verb first.

    Fields are in braces; what is in brackets needs ones that say something.
    """
    t: float
    run: str
    number: int
    wall: float

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.t:.2f} s{', ' * bool(said := self._brief())}{said}>"

    def _brief(self) -> str:
        """Return its line, or its own fields that are texts or numbers, for its repr."""
        own = ((name, getattr(self, name)) for name in self.fields[len(Event.fields) :])
        said = [(name, value) for name, value in own if isinstance(value, str | int | float) and value != ""]
        return self.words or ", ".join(
            f"{name}={value:.2f}" if isinstance(value, float) else f"{name}={value!r}" for name, value in said
        )

    @property
    def words(self) -> str:
        """Return its line in plain English, "" if it has none."""

        def fill(found: re.Match[str]) -> str:
            part, name, form = found.groups()
            if part is not None:
                return _FIELD.sub(fill, part) if all(map(is_said, _NAME.findall(part))) else ""
            value = getattr(self, name)
            return form.split("|")[not value] if isinstance(value, bool) else format(value, form or "")

        def is_said(name: str) -> bool:
            return getattr(self, name) not in ("", None, self.field_defaults.get(name))

        return _FIELD.sub(fill, self.line)

    @classmethod
    def stamp(cls, t: float, run: str, number: int, /, *data: Any, **more: Any) -> Event:
        """Return an event of this class that happens now. The only place that fills in the common fields."""
        return cls(t, run, number, time(), *data, **more)

    @property
    def count(self) -> int:
        """The number of numbers that it takes."""
        return 1


class StatusChanged(Event):
    """A node has a new status. `index` is its number in preorder, `path` its place.

    `before` is its last status in this round: IDLE if its parent has started again. `reason` says why a node failed, or
    what the condition of a rule measured when it became true. It is "" otherwise, and if only a node below it has it.
    """

    path: str
    node: Node
    status: int
    before: int
    index: int
    reason: str = ""


class StatusesChanged(Event):
    """Nodes have new statuses. Iterating yields each as a StatusChanged, oldest first, each with its number.

    They come together because creating an event for each would take ten times as long as the tick. `valued` has the
    nodes with ports that name keys, and the values of these keys (see Engine.valued).
    """

    changes: Changes
    nodes: Nodes
    valued: Mapping[int, Node] = {}

    @property
    def count(self) -> int:
        """The number of changes."""
        return len(self.changes)

    def _brief(self) -> str:
        first = islice(((index, status) for index, status, _, _ in self.changes), 3)
        said = ", ".join(f"{self.nodes.node(index).id} {NAMES[status]}" for index, status in first)
        return said + ", ..." * (len(self.changes) > 3)

    def without_paths(self) -> Iterator[tuple[int, int, int, str]]:
        """Yield index, new status, status before and reason of each change. Paths cost more than all the rest."""
        for index, status, before, fault in self.changes:
            is_told = status == FAILURE or (status == SUCCESS and fault is not None)
            yield index, status, before, self.nodes.reason(index, fault) if is_told else ""

    def values_now(self) -> dict[int, Node]:
        """Return `valued` without nodes that are IDLE again, whose keys may have the values of a later round by now."""
        if not self.valued:
            return {}
        latest = {index: status for index, status, _, _ in self.changes}
        return {index: node for index, node in self.valued.items() if latest.get(index) != IDLE}

    def __iter__(self) -> Iterator[StatusChanged]:
        nodes, number = self.nodes, self.number
        common = [getattr(self, name) for name in Event.fields]
        numbered = Event.fields.index("number")
        for index, status, before, reason in self.without_paths():
            common[numbered] = number
            path, node = nodes.path(index), nodes.node(index)
            yield StatusChanged(*common, path, node, status, before, index, reason)  # type: ignore[call-arg]
            number += 1


class Said(Event):
    """The robot speaks."""

    tag = "say"
    line = 'says "{text}"'
    text: str


class Printed(Event):
    """The robot shows a text."""

    tag = "print"
    line = 'prints "{text}"'
    text: str


class NavigationStarted(Event):
    """The robot sets out for a place, a person or an object."""

    tag = "navigate"
    name: str


class Chosen(Event):
    """The robot has chosen the nearest or a random name of a type; `seed` is that of the run's random choices."""

    tag = "choose"
    line = "chooses {name} ({how} {type}[; seed {seed}])"
    type: str
    how: str
    name: str
    seed: int | None = None


class Arrived(Event):
    """The robot has arrived at its goal."""

    tag = "arrive"
    name: str


class Bumped(Event):
    """The robot touches something, "" if it doesn't know what."""

    tag = "bump"
    alarms = True
    line = "bumps {into}"
    into: str


class Stuck(Event):
    """The wheels turn, but the robot doesn't move."""

    tag = "stuck"
    alarms = True
    line = "stuck"


class Stopped(Event):
    """The robot was stopped."""

    tag = "stop"


class Grasped(Event):
    """A hand, "left" or "right", holds something."""

    tag = "grasp"
    hand: str
    name: str


class Released(Event):
    """A hand was opened; None if it held nothing."""

    tag = "release"
    hand: str
    name: str | None


class Dropped(Event):
    """Something fell out of a hand."""

    tag = "drop"
    alarms = True
    line = "drops[ {name}]"
    hand: str
    name: str | None


class JointsMoved(Event):
    """Joints set out for these angles in degrees."""

    tag = "joint"
    targets: Mapping[str, float]


class Docked(Event):
    """The robot is at its charging station."""

    tag = "dock"


class Undocked(Event):
    """The robot is no longer at its charging station."""

    tag = "undock"


class BatteryEmpty(Event):
    """The battery is empty."""

    tag = "battery"
    alarms = True
    percent: float


class FaultInjected(Event):
    """A fault of the world file begins."""

    tag = "fault"
    alarms = True
    line = "[fault {text}]"
    kind: str
    text: str


class InTheWorld(Event):
    """What happens between the robot and what is around it."""


class Heard(InTheWorld):
    """The robot hears what somebody says, "" if it doesn't know who."""

    tag = "hear"
    line = 'hears "{text}"[ from {who}]'
    text: str
    who: str


class Asked(InTheWorld):
    """The robot waits for an answer to a question, by a person or, for "", by anybody."""

    tag = "ask"
    line = 'asks [{who}: ]"{text}"'
    text: str
    who: str


class Seen(InTheWorld):
    """The robot sees somebody or something for the first time."""

    tag = "see"
    line = "sees {name}"
    name: str


class Came(InTheWorld):
    """Somebody comes into the world."""

    tag = "come"
    line = "comes {name}"
    name: str


class Gone(InTheWorld):
    """Somebody leaves the world."""

    tag = "leave"
    line = "leaves {name}"
    name: str


class Called(InTheWorld):
    """The robot calls people for help."""

    tag = "call"
    line = 'calls "{text}"'
    text: str


class DoorMoved(InTheWorld):
    """A door was opened or closed."""

    tag = "door"
    line = "door {name} {open:open|closed}"
    name: str
    open: bool


class Switched(InTheWorld):
    """The robot has switched something on or off."""

    tag = "switch"
    line = "switch {name} {on:on|off}"
    name: str
    on: bool


class Given(InTheWorld):
    """A hand has given something to a person."""

    tag = "give"
    line = "gives {name} to {who}"
    hand: str
    name: str
    who: str


class Pictured(InTheWorld):
    """The robot has taken a picture; `name` lists who and what is in it, "" for nothing that the robot knows."""

    tag = "picture"
    line = "picture {name}"
    name: str


class LanguageChosen(InTheWorld):
    """From now on the robot speaks in the language `name`, such as "es"."""

    tag = "language"
    line = "speaks {name}"
    name: str


class StrokePlanned(Event):
    """The gesture `name` begins while the robot speaks. Its stroke is `stroke` seconds behind the beginning of what is
    said, that of its word `word` seconds: the stroke is later where the body can't be so fast.
    """

    tag = "stroke"
    name: str
    stroke: float
    word: float


class GestureStarted(InTheWorld):
    """The robot begins a gesture. It takes `slower` times as long as it should, for the limits of the joints."""

    tag = "gesture"
    line = "gestures {name}[ ({slower:g} times as long, for the limits of the joints)]"
    name: str
    slower: float = 1.0


class PartChanged(Event):
    """A component has another state (see btlang.components.component), or a device or the ears are "silent" or not.

    `kind` is "component", "device" or "ears"; what isn't silent "works". `text` says it to people, "" for
    what they need not know.
    """

    tag = "part"
    line = "[part {text}]"
    kind: str
    name: str
    state: str
    text: str = ""


class Notice(Event):
    """A text for people, about the node at `path` and a `place` of the mission, if any."""

    text: str
    path: str = ""
    place: str = ""


class Warned(Notice):
    """A warning that doesn't end the mission."""

    tag = "warning"
    alarms = True
    line = "[warning {text}]"


class Troubled(Notice):
    """Something went wrong outside the mission, such as a command that didn't halt."""

    tag = "error"
    alarms = True
    line = "[error {text}]"


class RobotEvent(Event):
    """Another event that a custom robot reports."""

    tag = "robot"
    kind: str
    data: Mapping[str, Any]


class Ended(Event):
    """The last event of a run, with the data of its Outcome: `outcome` (a status), `stopped`, `seconds`.

    `still` says whether the robot stands still (None if unknown); unless it is True, `motion` says so in words. If the
    mission failed, `path`, `id` and `reason` are those of the failure, and `place` that of its sentence.
    """

    tag = "end"
    outcome: str
    stopped: str
    seconds: float
    still: bool | None
    motion: str = ""
    path: str = ""
    id: str = ""
    reason: str = ""
    place: str = ""


class Overrun(Event):
    """A tick took `seconds` of real time, longer than its `period`. Only in runs that keep step with real time.

    `node` is its slowest leaf, at `path`, which took `leaf_seconds`; None if no leaf was the cause.
    """

    tag = "overrun"
    seconds: float
    period: float
    path: str = ""
    node: Node | None = None
    leaf_seconds: float = 0.0


class PeriodPassed(Event):
    """The period between two ticks is over, or one in which the robot comes to rest. Not in logs.

    The first one comes before the first tick. `ticks` and `overruns` count from the start of the run. `state` is what
    the robot senses. A sink that is called in the thread of the run may read `robot` during the call.
    """

    ticks: int
    overruns: int
    state: RobotState | None
    robot: Any

    @property
    def count(self) -> int:
        """The count 0: it has the number of the next event, so the numbers of a log have no gaps."""
        return 0


class Sampled(Event):
    """What a recording has beside, from time to time: `values` of the blackboard that are new or changed, and a `scan`.

    A scan has metres at even angles, counter-clockwise from straight ahead; inf where nothing is in range. Not in logs.
    """

    values: Mapping[str, Any]
    scan: tuple[float, ...] = ()

    @property
    def count(self) -> int:
        """The count 0: it has the number of the next event, too."""
        return 0


ROBOT_EVENTS: dict[str, type[Event]] = {
    event.tag: event
    for event in (
        Said, Printed, Chosen, NavigationStarted, Arrived, Bumped, Stuck, Stopped, Grasped, Released, Dropped,
        JointsMoved, Docked, Undocked, BatteryEmpty, FaultInjected, Heard, Asked, Seen, Came, Gone, Called, DoorMoved,
        Switched, Given, Pictured, LanguageChosen, StrokePlanned, GestureStarted, PartChanged, Warned, Troubled,
    )
}  # fmt: skip
"""The events that robots report, by the kinds of btlang.robots.robot.Robot.on_event."""
LOGGED: tuple[type[Event], ...] = (StatusChanged, *ROBOT_EVENTS.values(), RobotEvent, Overrun, Ended)
"""The events of a log."""

"""The one stream of everything that happens while a mission runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from btlang.engine.status import FAILURE
from btlang.record import Record
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol, TypeAlias

    from btlang.engine.build import Fault, Site
    from btlang.engine.watch import Changes

    Event: TypeAlias = "StatusesChanged | RobotEvent | Overrun | PeriodPassed"
    Sink: TypeAlias = Callable[[Event], object]

    class Nodes(Protocol):
        """What tells the nodes of a tree by their numbers."""

        def path(self, index: int) -> str: ...

        def node(self, index: int) -> Node: ...

        def reason(self, index: int, fault: Fault | Site | None) -> str: ...

    class Robot(Protocol):
        """What a run asks of a robot; see btlang.robots.robot.Robot. `moving`, `standstill`, `disable` and `enable` may
        be missing; so may `moves_by_itself`, which is then taken for true.

        `moves_by_itself` is False for a simulated robot, whose world stands still between two steps.
        """

        def step(self, dt: float) -> object: ...

        def stop(self) -> object: ...


class StatusChanged(Record):
    """Of a StatusesChanged: a node has a new status. `index` is its number in preorder, `path` its place; `t` is in
    seconds of the mission.

    `reason` says why a node failed, "" for any other status and where only a node below it can say that.
    """

    t: float
    index: int
    path: str
    node: Node
    status: int
    reason: str = ""


class StatusesChanged(Record):
    """Nodes have new statuses; iterating gives each as a StatusChanged, oldest first.

    They come together because making an event of each would take ten times as long as the tick. `valued` has those
    nodes whose ports name keys, with the values that these had (see Engine.valued).
    """

    t: float
    changes: Changes
    nodes: Nodes
    valued: Mapping[int, Node] = {}

    def __iter__(self) -> Iterator[StatusChanged]:
        nodes = self.nodes
        for index, status, fault in self.changes:
            reason = nodes.reason(index, fault) if status == FAILURE else ""
            yield StatusChanged(self.t, index, nodes.path(index), nodes.node(index), status, reason)


class RobotEvent(Record):
    """Something that the robot did or met: kind `say`, `print`, `bump`, ... with its data.

    The last event of a run is of the kind `end`: `outcome` (a status), `stopped` and `seconds` as in its Outcome,
    `still` (None where that is not known, and unless it is True `motion` in words) as in its `standstill`, and where it
    failed `path`, `id` and `reason` of the failure, and the `place` of its sentence in the mission.
    """

    t: float
    kind: str
    data: Mapping[str, Any] = {}


class Overrun(Record):
    """A tick took `seconds` of real time, longer than its `period`. Only in runs that keep step with real time.

    `node` is its slowest leaf, at `path`, which took `leaf_seconds` of them; None where no leaf is to blame.
    """

    t: float
    seconds: float
    period: float
    path: str = ""
    node: Node | None = None
    leaf_seconds: float = 0.0


class PeriodPassed(Record):
    """The time between two ticks is over, or one of the periods in which the robot comes to rest.

    The first one comes before the first tick. `ticks` and `overruns` count from the start of the run. A sink may read
    the robot during the call, and at no other time.
    """

    t: float
    ticks: int
    overruns: int
    robot: Robot | None


class EventStream:
    """Hands each event to all sinks, in the order they were added.

    A sink that raises is dropped and its exception kept in `errors`: what watches a mission must not stop it.
    `before` is called before an event of another sort than changes of statuses, to publish those that came earlier.
    """

    def __init__(self, *sinks: Sink) -> None:
        self.sinks: list[Sink] = list(sinks)
        self.errors: list[Exception] = []
        self.before: Callable[[], object] | None = None

    def add(self, sink: Sink) -> None:
        """Adds a sink, which gets the events from now on."""
        self.sinks.append(sink)

    def publish(self, event: Event) -> None:
        """Hands an event to all sinks."""
        if self.before is not None and not isinstance(event, StatusesChanged):
            self.before()
        for sink in tuple(self.sinks):
            try:
                sink(event)
            except Exception as problem:
                self.sinks.remove(sink)
                self.errors.append(problem)

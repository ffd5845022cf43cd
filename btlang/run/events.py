"""The one stream of everything that happens while a mission runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.record import Record
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol, TypeAlias

    Event: TypeAlias = "StatusChanged | RobotEvent | Overrun | PeriodPassed"
    Sink: TypeAlias = Callable[[Event], object]

    class Robot(Protocol):
        """What a run asks of a robot. `moving` may be missing; so may `moves_by_itself`, which is then taken for true.

        `moves_by_itself` is False for a simulated robot, whose world stands still between two steps.
        """

        def step(self, dt: float) -> object: ...

        def stop(self) -> object: ...


class StatusChanged(Record):
    """A node has a new status. `index` is its number in preorder, `path` its place; `t` is in seconds of the mission.

    `reason` says why a leaf or decorator failed, "" for any other status and where nothing is known.
    """

    t: float
    index: int
    path: str
    node: Node
    status: int
    reason: str = ""


class RobotEvent(Record):
    """Something that the robot did or met: kind `say`, `print`, `bump`, ... with its data."""

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
    """

    def __init__(self, *sinks: Sink) -> None:
        self.sinks: list[Sink] = list(sinks)
        self.errors: list[Exception] = []

    def add(self, sink: Sink) -> None:
        """Adds a sink, which gets the events from now on."""
        self.sinks.append(sink)

    def publish(self, event: Event) -> None:
        """Hands an event to all sinks."""
        for sink in tuple(self.sinks):
            try:
                sink(event)
            except Exception as problem:
                self.sinks.remove(sink)
                self.errors.append(problem)

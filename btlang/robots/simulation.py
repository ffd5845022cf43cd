"""A simulated robot in its world, for one mission or for several that follow each other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from btlang.engine.clock import Clock
from btlang.robots.simulated import SimulatedRobot
from btlang.robots.world import World
from btlang.run.events import EventStream, RobotEvent

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.leaf import LeafBinding
    from btlang.run.controls import Controls
    from btlang.run.events import Event, Sink
    from btlang.run.pace import Pace
    from btlang.tree.node import Tree
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.vocabulary import Vocabulary


class Simulation:
    """The world keeps its state from one run to the next; each run gets a clock and an event stream of its own."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.clock = Clock()
        self._untold: list[Event] = []  # faults from the start are there before anybody listens
        self.events = EventStream(self._untold.append)
        self.robot = SimulatedRobot(world, on_event=self._publish)

    def begin(self, sinks: Iterable[Sink]) -> None:
        """A new run: time starts at 0 and events go to these sinks."""
        self.clock, self.events = Clock(), EventStream(*sinks)
        for event in self._untold:
            self.events.publish(event)
        self._untold.clear()

    def bind(self, entry: Entry, vocabulary: Vocabulary) -> LeafBinding | None:
        """None: words are done by their `call`."""
        return None

    def check(self, tree: Tree, vocabulary: Vocabulary) -> None:
        """The simulated robot can do all that the shipped leaves need."""

    def pace(self, speed: float, controls: Controls) -> Pace:
        """Any speed will do: the world moves on as fast as it is asked to."""
        from btlang.run.pace import Pace

        return Pace(speed, controls)

    def close(self) -> None:
        """Does nothing: the world stays as it is."""

    def _publish(self, kind: str, data: Mapping[str, Any]) -> None:
        self.events.publish(RobotEvent(self.clock.now, kind, data))

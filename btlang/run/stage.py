"""Where a mission runs: a robot in its world, the clock, and the stream of what happens there."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol

from btlang.engine.clock import Clock
from btlang.run.controls import Controls
from btlang.run.events import EventStream
from btlang.run.pace import Pace
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.leaf import LeafBinding
    from btlang.run.events import Sink
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.vocabulary import Vocabulary


class Stage(Protocol):
    """One for a run, or for several that follow each other. Used by the thread of the run."""

    @property
    def clock(self) -> Clock:
        """Time of the run under way."""

    @property
    def events(self) -> EventStream:
        """What happens in the run under way."""

    @property
    def robot(self) -> Any:
        """The robot (btlang.robots.robot.Robot), which learns the places of the mission."""

    def bind(self, entry: Entry, vocabulary: Vocabulary) -> LeafBinding | None:
        """How the robot itself does what an entry says; None where its `call` does. Raises MissionError."""

    def check(self, tree: Tree, vocabulary: Vocabulary) -> None:
        """Raises MissionError where the robot lacks what the leaves of the tree need."""

    def begin(self, sinks: Iterable[Sink]) -> None:
        """A new run: time starts at 0 and events go to these sinks."""

    def pace(self, speed: float, controls: Controls) -> Pace:
        """What waits between two ticks. Raises ValueError for a speed that the stage cannot keep."""

    def close(self) -> None:
        """Lets go of the robot, at rest, within a few seconds. May be called twice."""

"""A robot that runs can use: itself, how it does words, and how its time passes."""

from __future__ import annotations

from typing import Any, Protocol

from btlang.run.bus import Bus
from btlang.run.controls import Controls
from btlang.run.pace import Pace
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon


class Connection(Protocol):
    """One for a run, or for several that follow each other. Used by the thread of the run."""

    @property
    def robot(self) -> Any:
        """The robot (btlang.robots.robot.Robot), which learns the places of the mission."""

    @property
    def bus(self) -> Bus:
        """That of the run under way."""

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """How the robot itself does what an entry says; None where its `call` does. Raises MissionError."""

    def check(self, tree: Tree, vocabulary: Lexicon) -> None:
        """Raises MissionError where the robot lacks what the leaves of the tree need."""

    def begin(self, bus: Bus) -> None:
        """A new run: what the robot reports goes on this bus."""

    def pace(self, speed: float, controls: Controls) -> Pace:
        """What waits between two ticks. Raises ValueError for a speed that the robot cannot keep."""

    def close(self) -> None:
        """Lets go of the robot, at rest, within a few seconds. May be called twice."""

"""A robot that runs can use, and what it has to know again where another run goes on."""

from __future__ import annotations

from typing import Any, Protocol

from btlang.run.bus import INLINE, Bus
from btlang.run.controls import Controls
from btlang.run.events import Chosen, LanguageChosen
from btlang.run.pace import Pace
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.run.events import Event
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon


class Connection(Protocol):
    """One for a run, or for several that follow each other. Used by the thread of the run."""

    @property
    def robot(self) -> Any:
        """The robot (btlang.robots.robot.Robot), which learns the places of the mission."""

    @property
    def bus(self) -> Bus:
        """The bus of the run under way."""

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """Return how the robot itself does what an entry says; None where its `call` does. Raises MissionError."""

    def check(self, tree: Tree, vocabulary: Lexicon) -> None:
        """Raise MissionError where the robot lacks what the leaves of the tree need."""

    def begin(self, bus: Bus) -> None:
        """Begin a new run: what the robot reports goes on this bus."""

    def pace(self, speed: float, controls: Controls) -> Pace:
        """Return what waits between two ticks. Raises ValueError for a speed that the robot cannot keep."""

    def close(self) -> None:
        """Let go of the robot, at rest, within a few seconds. May be called twice."""


class RunChoices:
    """A sink that counts the random choices of a run, and keeps the language in which it has the robot speak."""

    policy = INLINE

    def __init__(self) -> None:
        self._made, self._language = 0, ""

    def __call__(self, event: Event) -> None:
        if isinstance(event, Chosen) and event.how == "random":
            self._made += 1
        elif isinstance(event, LanguageChosen):
            self._language = event.name

    def save(self) -> dict[str, Any]:
        """Write the choices as JSON."""
        return {"choices": self._made, "language": self._language}

    def restore(self, saved: Mapping[str, Any], robot: Any, seed: int) -> None:
        """Raise KeyError, TypeError or ValueError where `save` never gave that, ActionFailed where the robot can't."""
        self._made = int(saved["choices"])
        if self._made:
            robot.seed_choices(seed, self._made)
        if language := str(saved.get("language", "")):
            robot.speak_in(language)

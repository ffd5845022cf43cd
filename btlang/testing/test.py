"""A test as data: a mission, the world that it runs in, and what is to happen while it runs."""

from __future__ import annotations

from btlang.api import Mission
from btlang.support.record import Record
from btlang.testing.fakes import Fake
from btlang.text.source import Span
from btlang.tree.node import Tree
from btlang.vocabulary.lexicon import Lexicon

USUAL_LIMIT = 600.0
"""Seconds of mission time after which a test is cut where it says nothing else."""

EVENT, HOLDS, WITHIN, FOR, BEFORE, ALWAYS, NEVER, FINALLY = (
    "event", "holds", "within", "for", "before", "always", "never", "finally",
)  # fmt: skip


class Step(Record):
    """A line of a test behind `run`; times count from the end of the step before it.

    `EVENT`: after `seconds`, and once `condition` is true, `event` happens in the world. `HOLDS`: after `seconds` the
    condition is true. `WITHIN`: it is true at some time in these seconds. `FOR`: it is true all that time. `BEFORE`: it
    is true before `other` is. `ALWAYS`, `NEVER` (whose condition is negated): from here to the end of the test.
    `FINALLY`: when the mission is over.
    """

    kind: str
    span: Span
    condition: Tree | None = None
    seconds: float = 0.0
    other: Tree | None = None
    event: Tree | None = None


class MissionTest(Record):
    """`setup` are the events before the first tick; `limit` is in seconds of mission time, and the test ends then.

    With `is_cut` that is too long: a test that gets there has failed. `vocabulary` has the words of its conditions.
    `texts` are the commands in quotes that its conditions ask for, as they are written. `robot` is the path of a robot
    file; "" is the robot that ships.
    """

    name: str
    span: Span
    mission: Mission
    vocabulary: Lexicon
    setup: tuple[Tree, ...] = ()
    fakes: tuple[Fake, ...] = ()
    steps: tuple[Step, ...] = ()
    texts: tuple[str, ...] = ()
    limit: float = USUAL_LIMIT
    is_cut: bool = True
    robot: str = ""

    @property
    def is_inline(self) -> bool:
        """Whether its mission stands in it."""
        syntax = self.mission.syntax
        return syntax is not None and syntax.span.source.name == self.span.source.name

    @property
    def place(self) -> str:
        """`file:line` of the test."""
        return self.span.place.rpartition(":")[0]

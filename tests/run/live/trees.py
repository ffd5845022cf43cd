"""Shapes and runs for the tests of the live view."""

from __future__ import annotations

from collections.abc import Iterable

from hypothesis import strategies as st

from btlang.engine.clock import Clock
from btlang.engine.compile import outline
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.run.events import StatusesChanged
from btlang.run.snapshot import RunState, Shape
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.changes import Changes

LETTERS = {"r": RUNNING, "s": SUCCESS, "f": FAILURE, "k": SKIPPED}


def shape_of(outline: str) -> Shape:
    """A shape from one line a node, indented by one blank a level."""
    depths = [len(line) - len(line.lstrip()) for line in outline.splitlines()]
    return shape_from(depths)


def shape_from(depths: Iterable[int]) -> Shape:
    """A shape from the depth of each node in preorder; a depth that is too large is cut."""
    parents: list[int] = []
    path: list[int] = []
    for index, depth in enumerate(depths):
        del path[max(depth, 1 if index else 0) :]
        parents.append(path[-1] if path else -1)
        path.append(index)
    return Shape(parents)


SHAPES = st.lists(st.integers(1, 12), max_size=120).map(lambda depths: shape_from([0, *depths]))


class Run:
    """An engine whose changes go to a State, second by second; leaves are scripts such as `rrs`, over and over."""

    def __init__(self, root: Node) -> None:
        self.clock = Clock()
        self.nodes, self.parents = outline(Tree(root))
        self.state = RunState(Shape(self.parents), self.nodes)
        self.latest: dict[int, int] = {}
        self.positions: dict[str, int] = {}
        self.engine = Engine(Tree(root), self._bind, clock=self.clock, listener=self._changed)

    def tick(self, times: int = 1) -> bytes:
        """The statuses after so many ticks, one a second."""
        for _ in range(times):
            self.engine.tick()
            self.clock.advance(1.0)
        return bytes(self.state.statuses)

    def suspend(self) -> bytes:
        """The statuses in a pause."""
        self.engine.suspend()
        return bytes(self.state.statuses)

    def _changed(self, changes: Changes) -> None:
        for change in StatusesChanged(self.clock.now, "", 0, 0.0, changes, self.engine):
            self.latest[change.index] = change.status
            self.state.change(change.index, change.status, change.t, change.reason)

    def _bind(self, id: str) -> LeafBinding:
        positions = self.positions

        class Leaf:
            def start(self) -> int:
                return self.tick()

            def tick(self) -> int:
                script = id.partition(":")[2]
                at = positions[id] = positions.get(id, -1) + 1
                return LETTERS[script[at % len(script)]]

            def halt(self) -> None:
                pass

        return LeafBinding(Leaf)

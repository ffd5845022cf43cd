"""Which nodes of a mission ran in its tests, and how they ended, drawn on its tree."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from btlang.api import Mission
from btlang.engine import status
from btlang.passes.lint.endings import FAILURE, SUCCESS, Ends, ends_of
from btlang.testing.observations import Observations
from btlang.testing.test import MissionTest
from btlang.tree.dump import outline
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold

_NAMES = {status.SUCCESS: "succeeded", status.FAILURE: "failed"}
_ENDS = {status.SUCCESS: SUCCESS, status.FAILURE: FAILURE}


def statuses_seen(tree: Tree, observed: Observations) -> tuple[int, ...]:
    """Of each node in the order of `Tree.walk` the statuses that it had: a bit for each. Uses of a subtree are one."""
    seen: dict[int, int] = {}
    for index, bits in observed.seen.items():
        key = id(observed.nodes[index])
        seen[key] = seen.get(key, 0) | bits
    return tuple(seen.get(id(node), 0) for node in tree.walk())


class Coverage:
    """What the tests of one mission have seen of it."""

    def __init__(self, mission: Mission) -> None:
        self._mission = mission
        self._nodes = list(mission.tree.walk())
        self._seen = [0] * len(self._nodes)
        self._ends = _possible(mission.tree)

    def add(self, seen: Sequence[int]) -> None:
        """What one test has seen."""
        if len(seen) == len(self._seen):
            self._seen = [before | bits for before, bits in zip(self._seen, seen, strict=True)]

    def lines(self, name: str) -> list[str]:
        """The counts of the mission with this name, and its tree with what never happened."""
        missing = {id(node): self._missing(at) for at, node in enumerate(self._nodes)}
        ran = sum(bool(bits) for bits in self._seen)
        possible = sum(len(self._outcomes(at)) for at in range(len(self._nodes)))
        happened = possible - sum(
            sum(not self._seen[at] & 1 << one for one in self._outcomes(at)) for at in range(len(self._nodes))
        )

        def label(node: Node) -> str:
            never = missing[id(node)]
            return f"{self._mission.label(node)}{f'   <- {never}' if never else ''}"

        counts = f"{name}: {ran} of {len(self._nodes)} nodes ran, {happened} of {possible} outcomes happened"
        return [counts, *outline(self._mission.tree, label).splitlines()]

    def _outcomes(self, at: int) -> list[int]:
        """The ways in which a node can end that count."""
        ends = self._ends.get(id(self._nodes[at]), SUCCESS | FAILURE)
        return [one for one, bit in _ENDS.items() if ends & bit]

    def _missing(self, at: int) -> str:
        seen = self._seen[at]
        if not seen:
            return "never ran"
        never = [_NAMES[one] for one in self._outcomes(at) if not seen & 1 << one]
        return f"never {' or '.join(never)}" if never else ""


def _possible(tree: Tree) -> dict[int, Ends]:
    """How each node can end, by its identity."""
    found: dict[int, Ends] = {}
    named: dict[str, Ends] = {}

    def ends(node: Node, children: list[Ends]) -> Ends:
        found[id(node)] = ends_of(node, children, named)
        return found[id(node)]

    for name, root in tree.subtrees:
        named[name] = fold(root, lambda node: node.children, ends)
    fold(tree.root, lambda node: node.children, ends)
    return found


def covered(tests: Iterable[tuple[MissionTest, Sequence[int]]]) -> dict[str, Coverage]:
    """The coverage of each mission by the name of its file; one that stands in a test has the place of the test."""
    found: dict[str, Coverage] = {}
    for test, seen in tests:
        name = test.place if test.is_inline or test.mission.syntax is None else test.mission.syntax.span.source.name
        if name not in found:
            found[name] = Coverage(test.mission)
        found[name].add(seen)
    return found

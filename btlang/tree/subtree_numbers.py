"""Which nodes are equal with all that is below them, at the cost of comparing two numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from btlang.tree.node import Node


class SubtreeNumbers:
    """The number of each node that was added; equal subtrees have the same. Nodes are keyed by identity.

    `features` gives what counts in a node beside its id, its name and its children.
    """

    def __init__(self, features: Callable[[Node], Iterable[tuple[str, str]]]) -> None:
        self._features = features
        self._kinds: dict[object, int] = {}
        self._numbers: dict[int, int] = {}
        self._kept: list[Node] = []  # so that no identity is given to another node

    def add(self, nodes: Iterable[Node]) -> None:
        """Counts nodes, each behind its children."""
        for node in nodes:
            below = tuple([self._numbers[id(child)] for child in node.children])
            key = node.id, node.name, tuple(self._features(node)), below
            self._numbers[id(node)] = self._kinds.setdefault(key, len(self._kinds))
            self._kept.append(node)

    def of(self, nodes: Iterable[Node]) -> list[int]:
        """Their numbers."""
        return [self._numbers[id(node)] for node in nodes]

    def __getitem__(self, node: Node) -> int:
        return self._numbers[id(node)]

    def are_equal(self, one: Node, other: Node) -> bool:
        """Whether two nodes and all that is below them are equal."""
        return self[one] == self[other]

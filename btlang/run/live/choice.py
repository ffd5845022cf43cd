"""A choice of nodes to show, and the rows that it needs."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

from btlang.run.shape import Shape


def hidden_from(shape: Shape, before: int, following: int) -> int:
    """The first node that needs a row of its own; what is below a folded node needs none."""
    if before < 0:
        return 0
    end = shape.ends[before]
    return end if end <= following else before + 1


class Choice:
    """Nodes that are shown, in preorder; it never needs more rows than there are."""

    def __init__(self, shape: Shape, height: int) -> None:
        self.nodes: list[int] = []
        self.room = height - 1  # one row stands for all nodes, as long as none is shown
        self._shape = shape

    def __contains__(self, node: int) -> bool:
        at = bisect_left(self.nodes, node)
        return at < len(self.nodes) and self.nodes[at] == node

    @property
    def full(self) -> bool:
        return self.room <= 0

    def add(self, node: int) -> bool:
        """Shows a node where its row, and those for what is then left out around it, fit; else does nothing."""
        at = bisect_left(self.nodes, node)
        following = self.nodes[at] if at < len(self.nodes) else len(self._shape)
        if following == node:
            return True
        before = self.nodes[at - 1] if at else -1
        cost = 1 + self._gap(before, node) + self._gap(node, following) - self._gap(before, following)
        if cost > self.room:
            return False
        self.nodes.insert(at, node)
        self.room -= cost
        return True

    def add_all(self, nodes: Sequence[int]) -> bool:
        """All of them or none. They are the children of a node that is shown folded up: each needs a row, no more."""
        if len(nodes) > self.room:
            return False
        at = bisect_left(self.nodes, nodes[0])
        self.nodes[at:at] = nodes
        self.room -= len(nodes)
        return True

    def folded(self, node: int) -> bool:
        """Whether nothing below a node that is shown is shown."""
        at = bisect_left(self.nodes, node) + 1
        return at == len(self.nodes) or self.nodes[at] >= self._shape.ends[node]

    def without_small_gaps(self) -> list[int]:
        """The nodes, and in place of each row that would stand for a single one, that one."""
        nodes: list[int] = []
        before = -1
        for following in (*self.nodes, len(self._shape)):
            start = hidden_from(self._shape, before, following)
            if start < following and (self._shape.ends[start] == following or start + 1 == following):
                nodes.append(start)
            nodes.append(following)
            before = following
        return nodes[:-1]

    def _gap(self, before: int, following: int) -> int:
        """The rows for what is left out between two nodes that are shown: 1 or 0."""
        return int(hidden_from(self._shape, before, following) < following)

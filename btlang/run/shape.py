"""The shape of a tree as lists over preorder numbers: what the choice of rows needs to be quick."""

from __future__ import annotations

from collections.abc import Iterator, Sequence


class Shape:
    """A node is its preorder number; all below node i are the numbers from i + 1 up to `ends[i]` (exclusive).

    `parents` holds the parent of each node (-1: the root), `before` the sibling in front of it (-1: there is none),
    `depths` the distance to the root, and `depth` the largest of them.
    """

    __slots__ = ("before", "depth", "depths", "ends", "parents")

    def __init__(self, parents: Sequence[int]) -> None:
        count = len(parents)
        self.parents = list(parents)
        self.ends = [i + 1 for i in range(count)]
        for i in range(count - 1, 0, -1):
            parent = parents[i]
            if self.ends[parent] < self.ends[i]:
                self.ends[parent] = self.ends[i]
        self.before, self.depths = [-1] * count, [0] * count
        latest = [-1] * count
        for i in range(1, count):
            self.before[i] = latest[parents[i]]
            latest[parents[i]] = i
            self.depths[i] = self.depths[parents[i]] + 1
        self.depth = max(self.depths)

    def __len__(self) -> int:
        return len(self.parents)

    def children(self, node: int) -> Iterator[int]:
        """The children of a node in order."""
        child, end = node + 1, self.ends[node]
        while child < end:
            yield child
            child = self.ends[child]

    def after(self, node: int) -> int:
        """The sibling behind a node, -1 if there is none."""
        parent, end = self.parents[node], self.ends[node]
        return end if parent >= 0 and end < self.ends[parent] else -1

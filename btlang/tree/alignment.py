"""Alignment of trees: which nodes of old trees have become which of new ones, as a careful reader would pair them."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Iterable, Sequence
from difflib import SequenceMatcher

from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Nodes: TypeAlias = Sequence[Node]

_MOST = 40_000  # comparisons of two lists of nodes; of longer ones only equal nodes are paired


class SubtreeNumbers:
    """The numbers of nodes; those of equal subtrees are the same. Nodes are keyed by identity.

    `features` gives what counts in a node beside its id, its name and its children.
    """

    def __init__(self, features: Callable[[Node], Iterable[tuple[str, str]]]) -> None:
        self._features = features
        self._kinds: dict[object, int] = {}
        self._numbers: dict[int, int] = {}
        self._kept: list[Node] = []  # so that no identity is given to another node

    def add(self, nodes: Iterable[Node]) -> None:
        """Give numbers to nodes, each behind its children."""
        for node in nodes:
            below = tuple([self._numbers[id(child)] for child in node.children])
            key = node.id, node.name, tuple(self._features(node)), below
            self._numbers[id(node)] = self._kinds.setdefault(key, len(self._kinds))
            self._kept.append(node)

    def of(self, nodes: Iterable[Node]) -> list[int]:
        """Return the numbers of nodes."""
        return [self._numbers[id(node)] for node in nodes]

    def __getitem__(self, node: Node) -> int:
        return self._numbers[id(node)]

    def are_equal(self, one: Node, other: Node) -> bool:
        """Whether two nodes and all that is below them are equal."""
        return self[one] == self[other]


class Alignment:
    """Pairs of new and old nodes. Nodes are keyed by identity, and none is in two places.

    Top down, then equal subtrees wherever they are, then what stands in or around something new: the phases of GumTree
    (Falleri et al., Fine-grained and accurate source code differencing, 2014), with children in their order.
    """

    def __init__(
        self,
        pairs: Iterable[tuple[Node, Node]],
        gone: Iterable[Node],
        come: Iterable[Node],
        features: Callable[[Node], Iterable[tuple[str, str]]],
    ) -> None:
        """Pair trees. `pairs` are old and new trees that belong together, `gone` and `come` other old and new ones.
        `features` returns what counts in a node beside its id, its name and its children.
        """
        self._features = features
        self._numbers = SubtreeNumbers(lambda node: sorted(features(node)))
        self._ranges: dict[int, tuple[int, int]] = {}  # the positions of a node and all below it
        self._positions: defaultdict[int, list[int]] = defaultdict(list)  # by number, ascending
        self._old: dict[int, Node] = {}
        self._new: dict[int, Node] = {}
        self._gaps: deque[tuple[Nodes, Nodes]] = deque()
        roots, lost, found = list(pairs), list(gone), list(come)
        before = [node for root in (*(old for old, _ in roots), *lost) for node in self._count(root)]
        after = [node for root in (*(new for _, new in roots), *found) for node in self._count(root)]
        self._pair_lists([([old], [new]) for old, new in roots])
        self._pair_equal(before, after)
        while self._gaps:
            self._pair_around(*self._gaps.popleft())

    def old(self, new: Node) -> Node | None:
        """Return what a new node was; None if it didn't exist."""
        return self._old.get(id(new))

    def new(self, old: Node) -> Node | None:
        """Return what an old node has become; None if it is gone."""
        return self._new.get(id(old))

    def is_equal(self, old: Node, new: Node) -> bool:
        """Whether two nodes and all that is below them are equal."""
        return self._numbers.are_equal(old, new)

    def _count(self, root: Node) -> list[Node]:
        """List the nodes of a tree, parents first, which get their numbers and positions."""
        nodes = list(Tree(root).walk())
        start = len(self._ranges)
        sizes: dict[int, int] = {}
        self._numbers.add(reversed(nodes))
        for node in reversed(nodes):
            sizes[id(node)] = 1 + sum([sizes[id(child)] for child in node.children])
        for at, node in enumerate(nodes, start):
            self._ranges[id(node)] = at, at + sizes[id(node)]
            self._positions[self._numbers[node]].append(at)
        return nodes

    def _pair_lists(self, waiting: list[tuple[Nodes, Nodes]]) -> None:
        """Pair what are children of the same, and then what is below them."""
        while waiting:
            old, new = waiting.pop()
            old, new = self._free(old, self._new), self._free(new, self._old)  # some have gone elsewhere
            before, after = self._numbers.of(old), self._numbers.of(new)
            matcher = SequenceMatcher(a=before, b=after, autojunk=False)
            for tag, first, last, begin, end in matcher.get_opcodes():
                if tag == "equal":
                    for one, other in zip(old[first:last], new[begin:end], strict=True):
                        self._pair_whole(one, other)
                    continue
                alike = self._alike(old[first:last], new[begin:end])
                for one, other in alike:
                    self._pair(one, other)
                    waiting.append((one.children, other.children))
                if len(alike) < max(last - first, end - begin):
                    self._gaps.append((old[first:last], new[begin:end]))

    def _pair(self, old: Node, new: Node) -> None:
        self._old[id(new)], self._new[id(old)] = old, new

    def _pair_whole(self, old: Node, new: Node) -> None:
        for one, other in zip(Tree(old).walk(), Tree(new).walk(), strict=True):
            if id(one) not in self._new and id(other) not in self._old:
                self._pair(one, other)

    def _alike(self, old: Nodes, new: Nodes) -> list[tuple[Node, Node]]:
        """Return the pairs of two lists, in their order, that have most in common together."""
        if not old or not new or len(old) * len(new) > _MOST:
            return []
        best = [[0.0] * (len(new) + 1) for _ in range(len(old) + 1)]
        scores = [[self._likeness(one, other) for other in new] for one in old]
        for i in range(len(old) - 1, -1, -1):
            for j in range(len(new) - 1, -1, -1):
                taken = scores[i][j] + best[i + 1][j + 1] if scores[i][j] else 0.0
                best[i][j] = max(best[i + 1][j], best[i][j + 1], taken)
        found: list[tuple[Node, Node]] = []
        i = j = 0
        while i < len(old) and j < len(new):
            if scores[i][j] and best[i][j] == scores[i][j] + best[i + 1][j + 1]:
                found.append((old[i], new[j]))
                i, j = i + 1, j + 1
            elif best[i][j] == best[i + 1][j]:
                i += 1
            else:
                j += 1
        return found

    def _likeness(self, old: Node, new: Node) -> float:
        """Return how much two nodes have in common; 0 if one hasn't become the other."""
        if self._holds(new, old) or self._holds(old, new):
            return 0.0  # something has come around it, or is gone from there
        shared = self._share(old, new)
        if old.id != new.id:
            return shared if old.children and new.children and shared >= 0.5 else 0.0
        for one, other in ((old, new), (new, old)):
            [*inner] = other.children
            if len(inner) == 1 and inner[0].id == one.id and self._share(one, inner[0]) > shared:
                return 0.0
        return 1 + shared + _overlap(self._features(old), self._features(new)) + (old.name == new.name != "")

    def _share(self, one: Node, other: Node) -> float:
        """Return the share of their children that both have."""
        return _overlap(self._numbers.of(one.children), self._numbers.of(other.children))

    def _holds(self, node: Node, inner: Node) -> bool:
        """Whether something equal to `inner` stands below a node."""
        first, end = self._ranges[id(node)]
        places = self._positions[self._numbers[inner]]
        at = bisect_left(places, first + 1)
        return at < len(places) and places[at] < end

    def _pair_equal(self, before: Nodes, after: Nodes) -> None:
        """Pair equal subtrees of what isn't paired, the largest first."""
        left: defaultdict[int, deque[Node]] = defaultdict(deque)
        for node in before:
            if id(node) not in self._new:
                left[self._numbers[node]].append(node)
        for new in sorted(after, key=self._size, reverse=True):
            if id(new) in self._old:
                continue
            same = left[self._numbers[new]]
            while same:
                old = same.popleft()
                if id(old) not in self._new:
                    self._pair_whole(old, new)
                    break

    def _size(self, node: Node) -> int:
        first, end = self._ranges[id(node)]
        return end - first

    def _pair_around(self, old: Nodes, new: Nodes) -> None:
        """Pair what is left in a gap: old nodes with those inside the new ones, and the other way round."""
        for node in new:
            one, inner = self._free(old, self._new), self._free(node.children, self._old)
            if id(node) not in self._old and one and inner:
                self._pair_lists([(one, inner)])
        for node in old:
            inner, one = self._free(node.children, self._new), self._free(new, self._old)
            if id(node) not in self._new and one and inner:
                self._pair_lists([(inner, one)])

    def _free(self, nodes: Nodes, paired: dict[int, Node]) -> list[Node]:
        return [node for node in nodes if id(node) not in paired]


def _overlap(one: Iterable[object], other: Iterable[object]) -> float:
    """Return the share of items that two collections have in common, from 0 to 1; 0 for empty ones."""
    first, second = Counter(one), Counter(other)
    total = max(first.total(), second.total())
    return (first & second).total() / total if total else 0.0

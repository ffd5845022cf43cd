"""Which nodes of a tree are shown where there is no room for all: a pure function of shape, statuses and rows."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.snapshot import HALTED, SUSPENDED, Shape
from btlang.support.record import Record


def first_visible(shape: Shape, before: int, following: int) -> int:
    """Return the first node that needs a row of its own; what is below a folded node needs none."""
    if before < 0:
        return 0
    end = shape.ends[before]
    return end if end <= following else before + 1


class NodeChoice:
    """A choice of nodes that are shown, in preorder; it never needs more rows than there are."""

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
        """Show a node where its row, and those for what is then left out around it, fit; else do nothing."""
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
        """Add all of them or none.

        They are the children of a node that is shown folded up: each needs a row, no more.
        """
        if len(nodes) > self.room:
            return False
        at = bisect_left(self.nodes, nodes[0])
        self.nodes[at:at] = nodes
        self.room -= len(nodes)
        return True

    def folded(self, node: int) -> bool:
        """Return whether nothing below a node that is shown is shown."""
        at = bisect_left(self.nodes, node) + 1
        return at == len(self.nodes) or self.nodes[at] >= self._shape.ends[node]

    def without_small_gaps(self) -> list[int]:
        """Return the nodes, and in place of each row that would stand for a single one, that one."""
        nodes: list[int] = []
        before = -1
        for following in (*self.nodes, len(self._shape)):
            start = first_visible(self._shape, before, following)
            if start < following and (self._shape.ends[start] == following or start + 1 == following):
                nodes.append(start)
            nodes.append(following)
            before = following
        return nodes[:-1]

    def _gap(self, before: int, following: int) -> int:
        """Return the rows for what is left out between two nodes that are shown: 1 or 0."""
        return int(first_visible(self._shape, before, following) < following)


LEAST_HEIGHT = 3

_WORTH_OPENING = 4  # rows that must be free for a part of a branch; with fewer it stays folded up
_KINDS = {IDLE: "to come", RUNNING: "running", SUCCESS: "done", FAILURE: "failed", SKIPPED: "skipped"}
_KINDS |= {HALTED: "halted", SUSPENDED: "halted"}
_LEVELS = "levels"


class Row(Record):
    """One line: a node, or (node -1) nodes that are left out, as (kind, how many) with a branch counted as one.

    `depth` is the distance to the root among what is shown, `inside` how many nodes below this one are left out
    where none of them is shown.
    """

    node: int
    depth: int
    inside: int = 0
    left_out: tuple[tuple[str, int], ...] = ()


def choose_rows(shape: Shape, statuses: bytearray, height: int) -> list[Row]:
    """Choose at most `height` (3 or more) rows, in the order of the tree; every node is in one of them.

    In the order of their importance: the deepest of what runs, the root, all else that runs with what is above it, the
    siblings around it, what failed, is to come or is done. What is finished is folded up first.
    """
    if len(shape) <= height:
        return _rows(shape, statuses, range(len(shape)))
    choice = NodeChoice(shape, height)
    tips = focus(shape, statuses, height)
    for node in (*tips[:1], 0, *tips[1:]):
        choice.add(node)
    shown = [tip for tip in tips if tip in choice]
    for node in _upward(shape, shown, height):
        choice.add(node)
    for node in _around(shape, choice):
        choice.add(node)
        if choice.full:
            break
    _unfold(shape, statuses, choice)
    return _rows(shape, statuses, choice.without_small_gaps())


def focus(shape: Shape, statuses: bytearray, most: int) -> list[int]:
    """Return what matters most, the deepest first: the running (else suspended) leaves, else the leaf that failed the
    tree.
    """
    for status in (RUNNING, SUSPENDED):
        tips = list(_tips(shape, statuses, status))
        if tips:
            deepest = max(tips, key=shape.depths.__getitem__)
            return [deepest, *(tip for tip in tips if tip != deepest)][:most]
    node = 0
    while statuses[node] == FAILURE:
        failed = [child for child in shape.children(node) if statuses[child] == FAILURE]
        if not failed:
            return [node]
        node = failed[-1]
    return [node] if node else []


def _tips(shape: Shape, statuses: bytearray, status: int) -> Iterator[int]:
    """Yield the nodes of a status that have none of it below."""
    node = statuses.find(status)
    while node >= 0:
        following = statuses.find(status, node + 1)
        if not 0 <= following < shape.ends[node]:
            yield node
        node = following


def _upward(shape: Shape, tips: Sequence[int], most: int) -> Iterator[int]:
    """Yield what is above the tips, the nearest first, as far as there can be room for it."""
    nodes = list(tips)
    for _ in range(most):
        nodes = [shape.parents[node] for node in nodes if shape.parents[node] > 0]
        nodes = list(dict.fromkeys(nodes))
        yield from nodes


def _around(shape: Shape, choice: NodeChoice) -> Iterator[int]:
    """Yield the siblings of what is shown, nearer ones first, where their parent is shown."""
    rings = [(node, node) for node in reversed(choice.nodes) if node and shape.parents[node] in choice]
    while rings:
        wider: list[tuple[int, int]] = []
        for left, right in rings:
            right = shape.after(right) if right >= 0 else -1
            left = shape.before[left] if left >= 0 else -1
            if right >= 0:
                yield right
            if left >= 0:
                yield left
            if left >= 0 or right >= 0:
                wider.append((left, right))
        rings = wider


def _unfold(shape: Shape, statuses: bytearray, choice: NodeChoice) -> None:
    """Open branches while there is room: failed ones, those to come, the others; at last a part of a long one."""
    order = {FAILURE: 0, IDLE: 1, RUNNING: 1}
    long: list[int] = []
    nodes = list(choice.nodes)
    while nodes and not choice.full:
        opened: list[int] = []
        for node in sorted(nodes, key=lambda node: order.get(statuses[node], 2)):
            if shape.ends[node] == node + 1 or not choice.folded(node):
                continue
            children = _first(shape.children(node), choice.room + 1)
            if choice.add_all(children):
                opened += children
            else:
                long.append(node)
        nodes = opened
    for node in long:
        if choice.room < _WORTH_OPENING:
            break
        for child in shape.children(node):
            if not choice.add(child):
                break


def _first(nodes: Iterator[int], most: int) -> list[int]:
    return [node for node, _ in zip(nodes, range(most), strict=False)]


def _rows(shape: Shape, statuses: bytearray, nodes: Sequence[int]) -> list[Row]:
    rows: list[Row] = []
    around: list[int] = []  # nodes that are shown and that the present place is below
    for at, node in enumerate((*nodes, len(shape))):
        start = first_visible(shape, nodes[at - 1] if at else -1, node)
        if start < node:
            _leave(shape, around, start)
            rows.append(Row(-1, len(around), 0, _counts(shape, statuses, start, node)))
        if node == len(shape):
            break
        _leave(shape, around, node)
        following = nodes[at + 1] if at + 1 < len(nodes) else len(shape)
        inside = shape.ends[node] - node - 1 if following >= shape.ends[node] else 0
        rows.append(Row(node, len(around), inside))
        around.append(node)
    return rows


def _leave(shape: Shape, around: list[int], node: int) -> None:
    while around and shape.ends[around[-1]] <= node:
        around.pop()


def _counts(shape: Shape, statuses: bytearray, start: int, end: int) -> tuple[tuple[str, int], ...]:
    counts: dict[str, int] = {}
    node = start
    while node < end:
        whole = shape.ends[node] <= end
        kind = _KINDS[statuses[node]] if whole else _LEVELS
        counts[kind] = counts.get(kind, 0) + 1
        node = shape.ends[node] if whole else node + 1
    return tuple(counts.items())

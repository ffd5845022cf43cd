"""Changes of statuses, and the places of nodes in which many of them are told at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from itertools import compress

from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.tree.catalogue import CATALOGUE, ON_SUCCESS
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Fault, NodeInstance


REACHED = 8
"""Added to the status of a node that has got it in the present tick."""
NOTHING = 1 << 60
"""Higher than any place of a node."""


def reports_each_round(node: Node) -> bool:
    """Whether each completion of the node's children is reported: it runs them again after a success, or so many times.

    What it runs until it succeeds, without a limit, is a condition that is waited for.
    """
    kind = CATALOGUE.get(node.id)
    return kind is not None and bool(kind.again) and (kind.again == ON_SUCCESS or not kind.is_endless(node.ports))


def differences(before: bytes, after: bytes) -> bytes:
    """Return bytes that are 0 where two texts of the same length are equal."""
    return (int.from_bytes(before) ^ int.from_bytes(after)).to_bytes(len(after))


class Layout:
    """The places of nodes, children before parents and siblings in order: as nodes complete that do so within a tick.

    `numbers` gives the number in preorder of the node at a place, `starts` the place of the first node below it or, for
    a leaf, its own.
    """

    __slots__ = ("instances", "numbers", "places", "starts")

    def __init__(self, instances: Sequence[NodeInstance]) -> None:
        self.instances = instances
        count = len(instances)
        sizes, depths = [1] * count, [0] * count
        for instance in instances[1:]:
            depths[instance.index] = depths[instance.above.index] + 1  # type: ignore[union-attr]
        for instance in instances[:0:-1]:
            sizes[instance.above.index] += sizes[instance.index]  # type: ignore[union-attr]
        self.places = [index + sizes[index] - 1 - depths[index] for index in range(count)]
        self.numbers, self.starts = [0] * count, [0] * count
        for index, place in enumerate(self.places):
            self.numbers[place] = index
            self.starts[place] = index - depths[index]


class Block:
    """Changes of nodes that completed one after the other within a tick, each of them once. A function may be RUNNING.

    `nodes` are their numbers in preorder, `statuses` the new ones, `before` those before, all of them oldest first.
    """

    __slots__ = ("_changed", "_faults", "_layout", "_low", "before", "nodes", "statuses")

    def __init__(
        self, layout: Layout, low: int, before: bytes, after: bytes, faults: dict[int, Fault | NodeInstance | None]
    ) -> None:
        size = len(after)
        changed = differences(before, after)
        self._layout, self._low, self._changed, self._faults = layout, low, changed, faults
        self.nodes = layout.numbers[low : low + size]
        if 0 in changed:
            self.nodes = list(compress(self.nodes, changed))
            before, after = bytes(compress(before, changed)), bytes(compress(after, changed))
        self.before, self.statuses = before, after

    def __len__(self) -> int:
        return len(self.nodes)

    def __iter__(self) -> Iterator[tuple[int, int, int, Fault | NodeInstance | None]]:
        faults, instances = self._faults, self._layout.instances
        for index, status, before in zip(self.nodes, self.statuses, self.before, strict=True):
            # a function that only returned False isn't among them
            yield index, status, before, faults.get(index, instances[index] if status == FAILURE else None)

    def touches(self, index: int) -> bool:
        """Return whether a node or one below it is among them."""
        place = self._layout.places[index]
        first, end = self._layout.starts[place] - self._low, place + 1 - self._low
        return end > 0 and any(self._changed[max(first, 0) : end])

    @property
    def has_running(self) -> bool:
        """Return whether a node is RUNNING or was so before."""
        return RUNNING in self.statuses or RUNNING in self.before

    def is_below(self, index: int) -> bool:
        """Return whether all of them are below a node."""
        place = self._layout.places[index]
        return self._layout.starts[place] <= self._low and self._low + len(self._changed) <= place


class Changes:
    """Changes of statuses, oldest first. Iterating yields for each the index of the node in preorder, its new status,
    the one before (IDLE in a new run of its parent), and for a FAILURE what had failed latest then: this node or one
    below. For the SUCCESS of a condition of a rule it is what was measured, where that is known.

    They are kept as numbers and blocks of them so that a change makes no new object: the garbage collector, which new
    objects call for, took longer than the rest of a tick.
    """

    __slots__ = ("_count", "entries", "faults")

    def __init__(self) -> None:
        self.entries: list[int | Block] = []
        """Of a single change its index, the status before and the new one, these in 3 bits each from the right."""
        self.faults: dict[int, Fault | NodeInstance | None] = {}  # by the position of a single change
        self._count = 0

    def add(self, index: int, before: int, status: int, fault: Fault | NodeInstance | None = None) -> None:
        """Add one change. `fault` counts if it is a FAILURE, or what a condition has measured."""
        if fault is not None and status in (FAILURE, SUCCESS):
            self.faults[len(self.entries)] = fault
        self.entries.append(index << 6 | before << 3 | status)
        self._count += 1

    def add_block(self, block: Block) -> None:
        """Add many changes."""
        self.entries.append(block)
        self._count += len(block)

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[tuple[int, int, int, Fault | NodeInstance | None]]:
        for position, entry in enumerate(self.entries):
            if isinstance(entry, int):
                yield entry >> 6, entry & 7, entry >> 3 & 7, self.faults.get(position)
            else:
                yield from entry

    def of(self, wanted: Set[int]) -> Iterator[tuple[int, int]]:
        """Yield index and new status of the changes of some nodes."""
        for entry in self.entries:
            if isinstance(entry, int):
                if entry >> 6 in wanted:
                    yield entry >> 6, entry & 7
            elif not wanted.isdisjoint(entry.nodes):
                yield from ((index, status) for index, status, _, _ in entry if index in wanted)

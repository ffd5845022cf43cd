"""Walks over trees as loops, because trees may be 10,000 deep."""

from __future__ import annotations

from collections.abc import Callable, Sequence

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    from btlang.tree.node import Node

    Item = TypeVar("Item")
    Result = TypeVar("Result")


def fold(
    root: Item, parts: Callable[[Item], Sequence[Item]], combine: Callable[[Item, list[Result]], Result]
) -> Result:
    """Combines each item with the results of its parts, parts first."""
    items: list[Item] = []
    counts: list[int] = []
    waiting = [root]
    while waiting:  # parents first and from right to left: backwards that is parts first and from left to right
        item = waiting.pop()
        inner = parts(item)
        items.append(item)
        counts.append(len(inner))
        waiting += inner
    results: list[Result] = []
    for item, count in zip(reversed(items), reversed(counts), strict=True):
        done: list[Result] = []
        if count:
            done = results[-count:]
            del results[-count:]
        results.append(combine(item, done))
    return results[0]


def children_first(root: Node) -> list[Node]:
    """Every node, children before their parents, from left to right."""
    found: list[Node] = []
    waiting = [root]
    while waiting:
        node = waiting.pop()
        found.append(node)
        waiting += node.children
    found.reverse()
    return found

"""Walks over trees as loops, because trees may be 10,000 levels deep."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from btlang.tree.catalogue import SUBTREE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    from btlang.tree.node import Node, Tree

    Item = TypeVar("Item")
    Result = TypeVar("Result")


def fold(
    root: Item, parts: Callable[[Item], Sequence[Item]], combine: Callable[[Item, list[Result]], Result]
) -> Result:
    """Combine each item with the results of its parts, parts first."""
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
    """List every node, children before their parents, from left to right."""
    found: list[Node] = []
    waiting = [root]
    while waiting:
        node = waiting.pop()
        found.append(node)
        waiting += node.children
    found.reverse()
    return found


def subtree_names(root: Node) -> list[str]:
    """List the names of the subtrees that a tree uses itself, from left to right, each as often as it is used."""
    return [node.port("ID") for node in children_first(root) if node.id == SUBTREE]


def used_subtrees(tree: Tree, names: Iterable[str] = ()) -> tuple[tuple[str, Node], ...]:
    """Return the subtrees of these names and those that they and the main tree use, in the order defined."""
    roots = dict(tree.subtrees)
    used = {name for name in names if name in roots}
    waiting = [tree.root, *(roots[name] for name in used)]
    while waiting:
        for name in subtree_names(waiting.pop()):
            if name in roots and name not in used:
                used.add(name)
                waiting.append(roots[name])
    return tuple((name, root) for name, root in tree.subtrees if name in used)


def in_order_of_use(uses: Mapping[str, Iterable[str]]) -> tuple[list[str], list[list[str]]]:
    """Return all names, each behind those that it uses, and the circles of names that use each other, each once.

    What is used and has no entry is left out.
    """
    ordered: list[str] = []
    circles: list[list[str]] = []
    done: set[str] = set()
    for start in uses:
        path: list[str] = []  # the names being followed, each used by the one before
        stack = [(start, False)]
        while stack:
            name, left = stack.pop()
            if left:
                path.pop()
                ordered.append(name)
            elif name in path:
                circles.append(path[path.index(name) :])
            elif name not in done:
                done.add(name)
                path.append(name)
                stack.append((name, True))
                stack += [(used, False) for used in reversed(dict.fromkeys(uses[name])) if used in uses]
    return ordered, circles

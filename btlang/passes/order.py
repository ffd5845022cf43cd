"""The trees of a tree, those that are used before those that use them."""

from __future__ import annotations

from btlang.tree.node import Node, Tree
from btlang.tree.visit import subtree_names


def used_first(tree: Tree) -> list[tuple[str, Node]]:
    """The subtrees by name, then the main tree under "", so that each comes behind those that it uses.

    A mission has them in this order, an XML file in any. What uses itself, or is not there, is left to others.
    """
    roots = dict(tree.subtrees)
    ordered: list[tuple[str, Node]] = []
    done: set[str] = set()
    for start in roots:
        stack = [(start, False)]
        while stack:
            name, left = stack.pop()
            if left:
                ordered.append((name, roots[name]))
            elif name not in done:
                done.add(name)
                stack.append((name, True))
                stack += [(used, False) for used in subtree_names(roots[name]) if used in roots and used not in done]
    return [*ordered, ("", tree.root)]

"""The trees of a tree, those that are used before those that use them."""

from __future__ import annotations

from btlang.tree.node import Node, Tree
from btlang.tree.visit import in_order_of_use, subtree_names


def used_first(tree: Tree) -> list[tuple[str, Node]]:
    """The subtrees by name, then the main tree under "", so that each comes behind those that it uses.

    A mission has them in this order, an XML file in any. What uses itself, or is not there, is left to others.
    """
    roots = dict(tree.subtrees)
    ordered, _ = in_order_of_use({name: reversed(subtree_names(root)) for name, root in roots.items()})
    return [*((name, roots[name]) for name in ordered), ("", tree.root)]

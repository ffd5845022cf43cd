"""A tree without what only editors write into its nodes, such as `_uid`: nobody says that."""

from __future__ import annotations

from btlang.frontends.btcpp.spelling import is_editors
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold


def without_editors(tree: Tree) -> Tree:
    """The tree without attributes of editors; the same one where it has none."""
    if not any(is_editors(name) for node in tree.walk() for name, _ in node.ports):
        return tree
    subtrees = tuple((name, _without(root)) for name, root in tree.subtrees)
    bare: Tree = tree.replace(root=_without(tree.root), subtrees=subtrees)
    return bare


def _without(root: Node) -> Node:
    def bare(node: Node, children: list[Node]) -> Node:
        ports = tuple(port for port in node.ports if not is_editors(port[0]))
        made: Node = node.replace(children=tuple(children), ports=ports)
        return made

    return fold(root, lambda node: node.children, bare)

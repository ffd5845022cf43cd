"""Size: names inside names can make a short mission grow beyond all measure."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import MOST_NODES, SUBTREE
from btlang.tree.node import Node


def check_size(compilation: Compilation) -> list[Diagnostic]:
    """BT042 where the tree has more than a million nodes once its names are filled in."""
    sizes: dict[str, int] = {}
    for name, root in compilation.roots:
        sizes[name] = _size(root, sizes)
    if sizes[""] <= MOST_NODES:
        return []
    return [diagnostic("BT042", compilation.tree.root.span or NOWHERE, limit=f"{MOST_NODES:,}")]


def _size(root: Node, sizes: dict[str, int]) -> int:
    total = 0
    stack = [root]
    while stack:
        node = stack.pop()
        total += 1 + (sizes.get(node.port("ID"), 0) if node.id == SUBTREE else 0)
        stack.extend(node.children)
    return total

"""Size: names inside names can make a short mission grow beyond all measure."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import MOST_NODES, SUBTREE


def check_size(compilation: Compilation) -> list[Diagnostic]:
    """BT042 where the tree has more than a million nodes once its names are filled in."""
    sizes: dict[str, int] = {}
    for name, nodes in compilation.nodes:
        used = (sizes.get(node.port("ID"), 0) for node in nodes if node.id == SUBTREE)
        sizes[name] = len(nodes) + sum(used)
    if sizes[""] <= MOST_NODES:
        return []
    return [diagnostic("BT042", compilation.tree.root.span or NOWHERE, limit=f"{MOST_NODES:,}")]

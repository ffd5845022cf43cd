"""SubTree nodes: each use of a named subtree is an instance of its own, with a blackboard of its own."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.build import EngineError, Site, blackboard_key
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


def subtree(site: Site, children: Sequence[Compiled]) -> Compiled:
    """Its tree, nothing else (subtree_node.cpp)."""
    [child] = children
    return child


def child_scope(node: Node, scope: Blackboard) -> Blackboard:
    """The blackboard of a SubTree node's tree.

    A port `key="{other}"` makes `key` there a name for `other` here, any other text is a value set once, as in C++.
    """
    if node.port("_autoremap", "false") not in ("false", "0"):
        raise EngineError("_autoremap is not supported: name each key that the subtree shares", node)
    ports = [(port, text) for port, text in node.ports if port != "ID" and not port.startswith("_")]
    keys = {port: blackboard_key(port, text) for port, text in ports}
    child = Blackboard({port: (scope, key) for port, key in keys.items() if key is not None}, scope)
    for port, text in ports:
        if keys[port] is None:
            child.set(port, text)
    return child

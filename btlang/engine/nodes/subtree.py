"""SubTree nodes: each use of a named subtree is an instance of its own, with a blackboard of its own."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import EngineError, NodeInstance, blackboard_key
from btlang.engine.nodes.ports import TRUTHS
from btlang.engine.script.values import literal
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def subtree(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Its tree, nothing else (subtree_node.cpp)."""
    [child] = children
    return child


def child_scope(node: Node, scope: Blackboard) -> Blackboard:
    """The blackboard of a SubTree node's tree.

    A port `key="{other}"` makes `key` there a name for `other` here, any other text is a value set once, a number where
    it is one, as in C++. With `_autoremap="true"` all keys but private ones (`_name`) are state that have no port.
    """
    shares = TRUTHS.get(text := node.port("_autoremap", "false"))
    if shares is None:
        raise EngineError(f"_autoremap must be true or false, not {text!r}", node)
    remapped: dict[str, tuple[Blackboard, str]] = {}
    values: dict[str, int | float | str] = {}
    for port, text in node.ports:
        if port == "ID" or port.startswith("_"):
            continue
        key = blackboard_key(port, text)
        if key is None:
            values[port] = literal(text)
        else:
            remapped[port] = (scope, key)
    return Blackboard(remapped, scope, shares=shares, values=values)

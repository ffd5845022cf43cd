"""Everything that keeps a tree from being compiled, where compiling stops at the first fault."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.compile import compile_node
from btlang.engine.instance import EngineError, EngineState, NodeInstance, halt_nothing
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.nodes.subtree import child_scope
from btlang.engine.status import SUCCESS
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import used_subtrees

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled


class UnknownNode(EngineError):
    """Neither a node of the engine nor bound to anything."""


class UnknownSubTree(EngineError):
    """A SubTree node names a tree that is not there."""


def faults(tree: Tree, bind: Callable[[str], LeafBinding | None], services: Mapping[str, Any]) -> list[EngineError]:
    """One for each node that cannot be compiled, and for each SubTree that closes a circle, in the order of Tree.walk.

    Trees that are not used are not looked at. `bind` and `services` are as for an Engine, which would refuse the tree
    where there is a fault; it refuses one of too many nodes, too.
    """
    state = EngineState(
        bind, Clock(), {"wake": None, "wake_at": None, "progress": None, "beside": None, **services}, {}, None
    )
    found: list[EngineError] = []
    uses: dict[str, list[Node]] = {}
    used = dict(used_subtrees(tree))
    for name, root in (("", tree.root), *used.items()):
        for node in Tree(root).walk():
            found += _wrong_with(node, used, state)
            if node.id == SUBTREE and node.port("ID") in used:
                uses.setdefault(name, []).append(node)
    return found + [EngineError(f"the subtree {node.port('ID')} contains itself", node) for node in _circles(uses)]


def _wrong_with(node: Node, subtrees: dict[str, Node], state: EngineState) -> Iterator[EngineError]:
    if node.id == SUBTREE:
        name = node.port("ID")
        if node.children:
            yield EngineError("it takes no children", node)
        if not name:
            yield EngineError("it needs a port ID", node)
        elif name not in subtrees:
            yield UnknownSubTree(f"there is no subtree {name}", node)
    elif node.id not in CATALOGUE:
        try:
            bound = state.bind(node.id)
        except EngineError as error:
            yield EngineError(error.message, node)
            return
        if bound is None:
            yield UnknownNode(f"nothing is bound to {node.id}", node)
            return
    standing_in: Compiled = (lambda: SUCCESS, halt_nothing)
    count = 1 if node.id == SUBTREE else len(node.children)
    try:
        if node.id == SUBTREE:
            child_scope(node, Blackboard())
        compile_node(NodeInstance(node, 0, None, 0, Blackboard(), state), [standing_in] * count)
    except EngineError as error:
        yield EngineError(error.message, node)


def _circles(uses: dict[str, list[Node]]) -> list[Node]:
    """The SubTree nodes that lead back to a tree around them."""
    closing: list[Node] = []
    around: set[str] = set()
    done: set[str] = set()
    stack: list[tuple[str, Iterator[Node]]] = [("", iter(uses.get("", ())))]
    while stack:
        name, rest = stack[-1]
        node = next(rest, None)
        if node is None:
            stack.pop()
            around.discard(name)
            done.add(name)
            continue
        inner = node.port("ID")
        if inner in around:
            closing.append(node)
        elif inner not in done:
            around.add(inner)
            stack.append((inner, iter(uses.get(inner, ()))))
    return closing

"""All faults that keep a tree from being compiled. Compiling itself stops at the first one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.compile import child_scope, compile_node
from btlang.engine.instance import EngineError, EngineState, NodeInstance, halt_nothing
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import SUCCESS
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import used_subtrees

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled


_ANY_VALUE = "{key}"
"""What every port takes when the tree is compiled."""


class UnknownNode(EngineError):
    """An error about a node that is neither built in nor bound to anything."""


class UnknownSubTree(EngineError):
    """An error about a SubTree node that names a tree that doesn't exist."""


def find_faults(
    tree: Tree, bind: Callable[[str], LeafBinding | None], services: Mapping[str, Any]
) -> list[EngineError]:
    """List an error for each node that can't be compiled, and for each SubTree in a circle, in the order of Tree.walk.

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
            found += _find_node_faults(node, used, state)
            if node.id == SUBTREE and node.port("ID") in used:
                uses.setdefault(name, []).append(node)
    return found + [EngineError(f"the subtree {node.port('ID')} contains itself", node) for node in _find_circles(uses)]


def _find_node_faults(node: Node, subtrees: dict[str, Node], state: EngineState) -> Iterator[EngineError]:
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
    try:
        if node.id == SUBTREE:
            child_scope(node, Blackboard())
    except EngineError as error:
        yield EngineError(error.message, node)
        return
    for message in _refusals(node, 1 if node.id == SUBTREE else len(node.children), state):
        yield EngineError(message, node)


def _refusals(node: Node, children: int, state: EngineState) -> list[str]:
    """List why a node can't be compiled. Compiling stops at the first reason, so that is changed before another try."""
    found: list[str] = []
    message = _refusal(node, children, state)
    while message and message not in found:
        found.append(message)
        tried = [(node, children, _refusal(node, children, state)) for node, children in _try_changes(node, children)]
        tried = [each for each in tried if each[2] not in found]
        if not tried:
            break
        node, children, message = min(tried, key=lambda each: each[2] != "")
    return found


def _refusal(node: Node, children: int, state: EngineState) -> str:
    """Return the first reason why a node can't be compiled, "" if there is none."""
    standing_in: Compiled = (lambda: SUCCESS, halt_nothing)
    try:
        compile_node(NodeInstance(node, 0, None, 0, Blackboard(), state), [standing_in] * children)
    except EngineError as error:
        return error.message
    return ""


def _try_changes(node: Node, children: int) -> Iterator[tuple[Node, int]]:
    """Yield a built-in node with one change that may correct it: the number of children, or a port."""
    kind = CATALOGUE.get(node.id)
    if kind is None:
        return
    if not kind.least <= children <= kind.most:
        yield node, kind.least
    given = dict(node.ports)
    for port in (*given, *kind.ports):
        yield node.replace(ports=tuple({**given, port: _ANY_VALUE}.items())), children
    for port in given:
        yield node.replace(ports=tuple(pair for pair in node.ports if pair[0] != port)), children


def _find_circles(uses: dict[str, list[Node]]) -> list[Node]:
    """List the SubTree nodes that lead back to a tree around them."""
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

"""Which subtrees are bodies of `for each`: each is used by one node alone, once for each value."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterator

from btlang.backends.english.code import Computed, computed
from btlang.support.record import Record
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree

_PREFIX = "each_"


class Loop(Record):
    """`rounds` are the SubTree nodes, each with the texts that are computed for it."""

    name: str
    key: str
    body: Node
    rounds: tuple[Computed, ...]


def find_loops(tree: Tree, refused: Container[str]) -> dict[int, Loop]:
    """The loops by the ids of the nodes that go through their values; `refused` are subtrees that are none."""
    bodies = {name: root for name, root in tree.subtrees if name.startswith(_PREFIX) and name not in refused}
    if not bodies:
        return {}
    nodes = list(_said_once(tree))
    uses = Counter(node.port("ID") for node in nodes if node.id == SUBTREE)
    loops: dict[int, Loop] = {}
    for node in nodes:
        rounds = [_round(node)] if uses[_used(node)] == 1 else [_round(child) for child in _children(node)]
        found = [one for one in rounds if one is not None and one.node.port("ID") in bodies]
        names = {one.node.port("ID") for one in found}
        if len(names) == 1 and len(found) == len(rounds) == uses[name := names.pop()]:
            key = _key(name, found)
            if key and name not in {loop.name for loop in loops.values()}:
                loops[id(node)] = Loop(name, key, bodies[name], tuple(found))
    return loops


def _said_once(tree: Tree) -> Iterator[Node]:
    """All nodes but the further rounds of `A 3 times 10 s apart`, which are the first one again."""
    stack = [root for _, root in reversed(tree.subtrees)]
    stack.append(tree.root)
    while stack:
        node = stack.pop()
        yield node
        children = node.children
        if len(children) == 2 and [part.id for part in children[1].children] == ["Delay"]:
            delay = children[1].children[0]
            children = children[: 1 + (delay.children != children[:1])]
        stack += reversed(children)


def _children(node: Node) -> tuple[Node, ...]:
    return node.children if node.id == "Sequence" and not node.ports and not node.name else ()


def _round(node: Node) -> Computed | None:
    if node.id == SUBTREE:
        return Computed(node, {})
    made = computed(node)
    return made if made is not None and made.node.id == SUBTREE else None


def _used(node: Node) -> str:
    """The subtree that a node alone uses."""
    found = _round(node)
    return found.node.port("ID") if found is not None else ""


def _key(name: str, rounds: list[Computed]) -> str:
    """The key that all rounds give a value; behind it the name may have a number."""
    key = name.removeprefix(_PREFIX)
    for one in (key, key.rpartition("_")[0]):
        if one and all(one in dict(found.node.ports) for found in rounds):
            return one
    return ""

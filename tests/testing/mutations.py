"""Mutations of missions: a step dropped, a count changed, a condition turned round. A good test tells them all."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.api import Mission
from btlang.support.record import Record
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node

COUNTS = ("num_cycles", "num_attempts")
"""The ports that hold how often something is done."""
NOT = "Inverter"


class Mutation(Record):
    """A changed mission, and what was changed."""

    what: str
    mission: Mission


def mutations(mission: Mission) -> Iterator[Mutation]:
    """All of them, in the order of the tree."""
    tree = mission.tree
    for name, root in (("", tree.root), *tree.subtrees):
        for what, changed in _changes(root, mission):
            if name:
                subtrees = tuple((known, changed if known == name else other) for known, other in tree.subtrees)
                mutant = tree.replace(subtrees=subtrees)
            else:
                mutant = tree.replace(root=changed)
            yield Mutation(what, mission.replace(tree=mutant))


def _changes(node: Node, mission: Mission) -> Iterator[tuple[str, Node]]:
    """What can be changed in a tree, each with the tree after it."""
    for what, changed in _own_changes(node, mission):
        yield what, changed
    for at, child in enumerate(node.children):
        for what, changed in _changes(child, mission):
            yield what, _with_child(node, at, changed)


def _with_child(node: Node, at: int, child: Node) -> Node:
    changed: Node = node.replace(children=(*node.children[:at], child, *node.children[at + 1 :]))
    return changed


def _own_changes(node: Node, mission: Mission) -> Iterator[tuple[str, Node]]:
    kind = CATALOGUE.get(node.id)
    if kind is not None and not kind.roles and kind.most > 1 and len(node.children) > 1:
        for at, child in enumerate(node.children):
            without = node.replace(children=node.children[:at] + node.children[at + 1 :])
            yield f"dropped: {_said(child, mission)}", without
    for port, text in node.ports:
        if port in COUNTS and text.isdecimal():
            for count in {int(text) + 1, max(1, int(text) - 1)} - {int(text)}:
                ports = tuple((key, str(count) if key == port else value) for key, value in node.ports)
                yield f"{port} of {_said(node, mission)}: {count}", node.replace(ports=ports)
    entry = mission.vocabulary.entry(node.id)
    if entry is not None and entry.sort == "condition":
        yield f"turned round: {_said(node, mission)}", Node(NOT, (node,))
    if node.id == NOT and not node.children[0].children:
        yield f"turned round: not {_said(node.children[0], mission)}", node.children[0]


def _said(node: Node, mission: Mission) -> str:
    return mission.label(node) if not node.children else f"{mission.label(node)} of {len(node.children)}"

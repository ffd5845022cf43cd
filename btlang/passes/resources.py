"""Resources of the robot: two parts of a parallel must not hold the same one, also through named subtrees."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.vocabulary import Vocabulary

Holders = dict[str, Node]
"""Resource -> a leaf (or name) that holds it."""


def check_resources(tree: Tree, vocabulary: Vocabulary) -> list[Diagnostic]:
    """BT041 once for each parallel and resource that two of its children need."""
    problems: list[Diagnostic] = []
    held_by_name: dict[str, Holders] = {}

    def combine(node: Node, children: list[Holders]) -> Holders:
        if node.id == "SubTree":
            return dict.fromkeys(held_by_name.get(node.port("ID"), ()), node)
        entry = vocabulary.entry(node.id)
        held: Holders = dict.fromkeys(entry.resources, node) if entry else {}
        told: set[str] = set()
        for child in children:
            if node.id.startswith("Parallel"):
                both = sorted(held.keys() & child.keys() - told)
                problems.extend(_conflict(resource, held[resource], child[resource]) for resource in both)
                told.update(both)
            held = {**child, **held}
        return held

    for name, root in tree.subtrees:  # used ones come before their users
        held_by_name[name] = fold(root, lambda node: node.children, combine)
    fold(tree.root, lambda node: node.children, combine)
    return problems


def _conflict(resource: str, first: Node, second: Node) -> Diagnostic:
    assert first.span is not None
    assert second.span is not None
    one, other = first.span.text, second.span.text
    notes = ((first.span, f"this needs the {resource} too"),)
    return diagnostic(
        "BT041", second.span, notes, resource=resource, first=one, second=other, fixed=f"{one} then {other}"
    )

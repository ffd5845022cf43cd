"""Resources of the robot: two parts of a parallel must not hold the same one, also through named subtrees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node
from btlang.tree.visit import children_first

Holders = Mapping[str, Node]
"""Resource -> a leaf (or name) that holds it."""

_NONE: Holders = {}  # one for all


def check_resources(compilation: Compilation) -> list[Diagnostic]:
    """BT041 once for each parallel and resource that two of its children need."""
    vocabulary = compilation.vocabulary
    problems: list[Diagnostic] = []
    held_by_name: dict[str, Holders] = {}
    for name, root in compilation.roots:
        results: list[Holders] = []
        for node in children_first(root):
            count = len(node.children)
            if count:
                inner = results[-count:]
                del results[-count:]
                kind = CATALOGUE.get(node.id)
                if kind is not None and kind.at_once:
                    problems += _conflicts(inner)
                results.append(_joined(inner))
            elif node.id in vocabulary.entries:
                results.append(dict.fromkeys(vocabulary.entries[node.id][0].resources, node))
            elif node.id == SUBTREE:
                results.append(dict.fromkeys(held_by_name.get(node.port("ID"), ()), node))
            else:
                results.append(_NONE)
        held_by_name[name] = results[0]
    return problems


def _joined(holders: Sequence[Holders]) -> Holders:
    """What all of them hold; the first holder of each resource."""
    some = [held for held in holders if held]
    if len(some) < 2:
        return some[0] if some else _NONE
    joined: dict[str, Node] = {}
    for held in reversed(some):
        joined.update(held)
    return joined


def _conflicts(parts: Sequence[Holders]) -> list[Diagnostic]:
    """Each resource that two of the parts hold, once."""
    held: dict[str, Node] = {}
    found: list[Diagnostic] = []
    told: set[str] = set()
    for part in parts:
        both = sorted(held.keys() & part.keys() - told)
        found += [_conflict(resource, held[resource], part[resource]) for resource in both]
        told.update(both)
        held = {**part, **held}
    return found


def _conflict(resource: str, first: Node, second: Node) -> Diagnostic:
    one, other = (node.id if node.span is None else node.span.text for node in (first, second))
    notes = ((first.span, f"this needs the {resource} too"),) if first.span is not None else ()
    fixed = f"{one} then {other}"
    if one[:1] == "<":
        fixed = f"<Sequence> {one} {other} </Sequence>"
    elif first.span is None or one[:1] == '"':  # of JSON
        fixed = f"{first.id} and {second.id} as children of a Sequence"
    span = second.span or NOWHERE
    return diagnostic("BT041", span, notes, resource=resource, first=one, second=other, fixed=fixed)

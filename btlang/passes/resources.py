"""Resources of the robot: two parts of a parallel must not hold the same one, also through named subtrees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node

Holders = Mapping[str, Node]
"""Resource -> a leaf (or name) that holds it."""

_NONE: Holders = {}  # one for all


def check_resources(compilation: Compilation) -> list[Diagnostic]:
    """BT041 once for each parallel and resource that two of its children need."""
    vocabulary = compilation.vocabulary
    needs = {id: vocabulary.entries[id][0].resources for id in compilation.ids if id in vocabulary.entries}
    at_once = {id for id in compilation.ids if id in CATALOGUE and CATALOGUE[id].at_once}
    problems: list[Diagnostic] = []

    def combine(node: Node, children: Sequence[Holders], named: dict[str, Holders]) -> Holders:
        if children:
            if node.id in at_once:
                problems.extend(_conflicts(children))
            return _joined(children)
        resources = named.get(node.port("ID"), ()) if node.id == SUBTREE else needs.get(node.id)
        return dict.fromkeys(resources, node) if resources else _NONE

    if at_once:
        compilation.fold(combine)
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

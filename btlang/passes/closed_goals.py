"""BT162: journeys to a place that the robot has to keep out of meanwhile, by a constraint of the same statement."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree.catalogue import CONSTRAINTS, SEQUENCE, SUBTREE, zone_names
from btlang.tree.node import Node
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.value_type import PLACE

_KEEP_OUT, _ENTER, _OPEN = CONSTRAINTS["keep out"], "EnterZone", "OpenZone"

Goals = Mapping[str, Node]
"""The names of places and zones to which a part of the tree drives, or through which; each with a leaf that does."""
_NONE: Goals = {}  # one for all


def check_goals(compilation: Compilation) -> list[Diagnostic]:
    """Below each KeepOut, and behind each command that closes a zone until the mission ends."""
    entries = compilation.vocabulary.entries
    known = {id: entries[id][0] for id in compilation.ids if id in entries}
    closing = {id for id, entry in known.items() if entry.constrains == "keep out"} if _OPEN not in known else set()
    problems: list[Diagnostic] = []

    def report(closed: Iterable[str], goals: Goals) -> None:
        for zone in closed if goals else ():
            node = goals.get(zone.lower())
            if node is not None and node.span is not None:
                problems.append(diagnostic("BT162", node.span, words=node.source_text, zone=zone))

    def combine(node: Node, children: Sequence[Goals], named: dict[str, Goals]) -> Goals:
        if not children:
            if node.id == SUBTREE:
                return named.get(node.port("ID"), _NONE)
            return _goals(node, known[node.id]) if node.id in known else _NONE
        if node.id == _KEEP_OUT:
            report(zone_names(node.port("zones")), children[0])
        elif node.id == SEQUENCE:
            closed: dict[str, None] = {}
            for child, goals in zip(node.children, children, strict=True):
                report(closed, goals)
                if child.id in closing:
                    closed.update(dict.fromkeys(text for _, text in child.ports))
        return {name: leaf for goals in children for name, leaf in goals.items()}

    if _KEEP_OUT in compilation.ids or closing:
        compilation.fold(combine)
    return problems


def _goals(node: Node, entry: Entry) -> Goals:
    if MOVES not in entry.resources or entry.constrains:
        return _NONE
    names = [slot.name for slot in entry.slots if slot.type == PLACE or entry.id == _ENTER]
    texts = [text for name, text in node.ports if name in names]
    return {name.lower(): node for text in texts for name in zone_names(text)}

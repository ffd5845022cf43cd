"""Types of entries of blackboards: two ports give one entry different types (BT132), or one a text that is no number
(BT246).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.engine.instance import blackboard_key
from btlang.frontends.btcpp.spelling import AUTOREMAP, TRUE
from btlang.projects.entries import EntryUse, TreeEntries
from btlang.projects.ports import attribute_value
from btlang.tree.catalogue import SCRIPT, port_content
from btlang.tree.node import Node
from btlang.tree.visit import in_order_of_use

_SAME = {"int32_t": "int", "unsigned": "unsigned int", "uint32_t": "unsigned int", "string": "std::string"}
_SCALARS = ("bool", "double", "float", "int", "unsigned int", "int8_t", "int16_t", "uint8_t", "uint16_t")
_TEXT = "std::string"
_MESSAGE = re.compile(r"\w+::msg::\w+")
_LIST = re.compile(r"std::(?:vector|deque|list)\s*<(.+)>")


def conflicting_types(entries: Mapping[str, TreeEntries]) -> Iterator[Diagnostic]:
    """Report BT132 for ports whose entry has another type since an earlier port, as BehaviorTree.CPP 4 refuses them.

    BT246 where it converts the text that an output sets. A SubTree node counts with the first port of its tree that has
    the entry. What a tree gets from outside is reported where the entry is; version 3 isn't checked.
    """
    outside: dict[str, set[str]] = {}
    shared: set[str] = set()
    for each in entries.values():
        for node in each.subtrees:
            outside.setdefault(node.port("ID"), set()).update(port for port, _ in node.ports)
            if node.port(AUTOREMAP) in TRUE:
                shared.add(node.port("ID"))
    firsts: dict[str, dict[str, EntryUse]] = {}
    uses = {name: [node.port("ID") for node in each.subtrees] for name, each in entries.items()}
    for name in in_order_of_use(uses)[0]:
        each = entries[name]
        if each.is_older:
            continue
        first = firsts[name] = {}
        reported: set[tuple[int, str]] = set()
        for step in each.steps:
            for key, use, place in _named(step, firsts):
                before = first.setdefault(key, use)
                at = id(use.node), use.port
                if name not in shared and key not in outside.get(name, ()) and at not in reported:
                    for problem in _conflict(key, before, use, place):
                        reported.add(at)
                        yield problem


def _named(
    step: EntryUse | Node, firsts: Mapping[str, Mapping[str, EntryUse]]
) -> Iterator[tuple[str, EntryUse, EntryUse]]:
    """Yield the entries that a node names: each key with the port that has it first, which may be in another tree, and
    the port here.
    """
    if isinstance(step, EntryUse):
        if port_content(step.node.id, step.port) != SCRIPT:
            yield step.key, step, step
        return
    inner = firsts.get(step.port("ID"))
    given = {port for port, _ in step.ports}
    for port, text in step.ports:
        key = blackboard_key(port, text)
        if key is not None and key[:1] != "@":
            here = EntryUse(step, port, key)  # of no known type, if nothing is known of the tree
            yield key, (here if inner is None or port not in inner else inner[port]), here
    if step.port(AUTOREMAP) in TRUE and inner is not None:
        for key, use in inner.items():
            if key not in given and key[:1] != "_":
                yield key, use, EntryUse(step, AUTOREMAP, key)


def _conflict(key: str, before: EntryUse, use: EntryUse, here: EntryUse) -> Iterator[Diagnostic]:
    is_inside = use.node is not here.node
    notes = [(attribute_value(before.node, before.port), f"here '{key}' gets its type")]
    if is_inside:
        notes.append((attribute_value(use.node, use.port), f"here it is of type {use.type}"))
    place = attribute_value(here.node, here.port)
    if before.type == _TEXT and not before.reads and use.type in _SCALARS:
        yield diagnostic("BT246", place, tuple(notes), None, key=key, id=use.node.id, port=use.port, type=use.type)
    elif _differ(before.type, use.type):
        reason = f"'{key}' is of type {before.type}, and its port {here.port} is of type {use.type}"
        if here.port == AUTOREMAP:
            reason = f"'{key}' is of type {before.type}, and in its tree of type {use.type}"
        yield diagnostic("BT132", place, tuple(notes), None, id=here.node.id, reason=reason)


def _content(type: str) -> str:
    """Return the type of what is in a list, "-" if the type is none."""
    return match[1].strip() if (match := _LIST.fullmatch(type)) else "-"


def _differ(first: str, later: str) -> bool:
    """Return whether two types surely differ, the first of which isn't a text, from which everything can be read."""
    first, later = _SAME.get(first, first), _SAME.get(later, later)
    if _content(first) == later or _content(later) == first:
        return True
    if first == later or not (first in _SCALARS or _MESSAGE.fullmatch(first)):
        return False
    return later in _SCALARS or (first in _SCALARS and (later == _TEXT or _MESSAGE.fullmatch(later) is not None))

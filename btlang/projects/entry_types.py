"""Types of entries of blackboards: two ports or values give one entry different types (BT132), a constant isn't of the
type (BT233), or a text may not be (BT246).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.engine.instance import blackboard_key
from btlang.engine.script.assignments import NUMBER, TEXT
from btlang.engine.script.tokens import BOOLEANS
from btlang.engine.script.values import as_text, literal
from btlang.frontends.btcpp.spelling import AUTOREMAP, TRUE
from btlang.projects.entries import EntryUse, TreeEntries
from btlang.projects.ports import attribute_value, describe_type
from btlang.text.source import Span
from btlang.tree.catalogue import CATALOGUE, SCRIPT, SUBTREE, port_content
from btlang.tree.node import Node
from btlang.tree.visit import in_order_of_use

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Uses: TypeAlias = dict[str, list[EntryUse]]
    """Those that differ in type or constant, by key."""

_POSES = "std::vector<geometry_msgs::msg::PoseStamped>"  # which nav_msgs::msg::Goals replaced in newer versions of Nav2
_SAME = {"int32_t": "int", "unsigned": "unsigned int", "uint32_t": "unsigned int", "string": "std::string",
         "nav_msgs::msg::Goals": _POSES}  # fmt: skip
_SCALARS = ("bool", "double", "float", "int", "unsigned int", "int8_t", "int16_t", "uint8_t", "uint16_t")
_TEXT = "std::string"
_MESSAGE = re.compile(r"\w+::msg::\w+")
_LIST = re.compile(r"std::(?:vector|deque|list)\s*<(.+)>")
_HEX = ("0x", "0X")
_MOST = 8  # uses of an entry that a tree passes on to those around it


def conflicting_types(entries: Mapping[str, TreeEntries]) -> Iterator[Diagnostic]:
    """Report BT132 for ports whose entry has another type since an earlier port, as BehaviorTree.CPP 4 refuses them.

    BT132 also for values of scripts that an entry can't become, and BT233 for constants that aren't of its type. BT246
    where BehaviorTree.CPP converts the text that an output sets. A SubTree node counts with the ports and values of its
    tree. What a tree gets from outside is reported where the entry is; version 3 isn't checked.
    """
    outside: dict[str, set[str]] = {}
    shared: set[str] = set()
    for each in entries.values():
        for node in each.subtrees:
            outside.setdefault(node.port("ID"), set()).update(port for port, _ in node.ports)
            if node.port(AUTOREMAP) in TRUE:
                shared.add(node.port("ID"))
    known: dict[str, Uses] = {}
    uses = {name: [node.port("ID") for node in each.subtrees] for name, each in entries.items()}
    for name in in_order_of_use(uses)[0]:
        each = entries[name]
        if each.is_older:
            continue
        named = [found for step in each.steps for found in _named(step, known)]
        own = known[name] = {}
        for key, use, _ in named:
            before = own.setdefault(key, [])
            if len(before) < _MOST and all((use.type, use.constant) != (one.type, one.constant) for one in before):
                before.append(use)
        if name not in shared:
            given = outside.get(name, ())
            yield from _conflicts([found for found in named if found[0] not in given], own)
        for node in each.subtrees:
            yield from _wrong_in_subtree(node, known.get(node.port("ID"), {}))


def _named(step: EntryUse | Node, known: Mapping[str, Uses]) -> Iterator[tuple[str, EntryUse, EntryUse]]:
    """Yield the entries that a node names: each key with the port or value, which may be in another tree, and the port
    here.
    """
    if isinstance(step, EntryUse):
        if _is_value(step) or port_content(step.node.id, step.port) != SCRIPT:
            yield step.key, step, step
        return
    inner = known.get(step.port("ID"), {})
    given = {port for port, _ in step.ports}
    for port, text in step.ports:
        key = blackboard_key(port, text)
        if key is not None and key[:1] != "@":
            here = EntryUse(step, port, key)  # of no known type, if nothing is known of the tree
            for use in inner.get(port, [here]):
                yield key, use, here
    if step.port(AUTOREMAP) in TRUE:
        for key, uses in inner.items():
            if key not in given and key[:1] != "_":
                for use in uses:
                    yield key, use, EntryUse(step, AUTOREMAP, key)


def _conflicts(
    named: Sequence[tuple[str, EntryUse, EntryUse]], own: Mapping[str, Sequence[EntryUse]]
) -> Iterator[Diagnostic]:
    reported: set[tuple[int, str]] = set()
    for key, use, here in named:
        at = id(here.node), here.port
        find = _wrong_value if _is_value(use) else _conflict
        for problem in find(key, own[key], use, here) if at not in reported else ():
            reported.add(at)
            yield problem


def _conflict(key: str, own: Sequence[EntryUse], use: EntryUse, here: EntryUse) -> Iterator[Diagnostic]:
    """Report that a port has another type than the first port of its entry, which is `own` to a tree."""
    before = next(one for one in own if not _is_value(one))
    if before.type == _TEXT and not before.reads and use.type in _SCALARS:
        place, notes = _places(key, before, use, here)
        yield diagnostic("BT246", place, notes, None, key=key, id=use.node.id, port=use.port, type=use.type)
    elif _differ(before.type, use.type):
        later = "in its tree" if here.port == AUTOREMAP else f"its port {here.port} is"
        yield _refused(key, f"of type {before.type}, and {later} of type {use.type}", before, use, here)


def _wrong_value(key: str, own: Sequence[EntryUse], use: EntryUse, here: EntryUse) -> Iterator[Diagnostic]:
    """Report that a value can't become what the first port of its entry is, or else what the first value is."""
    maker = "its tree" if here.port == AUTOREMAP else f"its port {here.port}"
    typed = next((one for one in own if not _is_value(one) and one.type), None)
    if typed is not None and use.type == NUMBER and _MESSAGE.fullmatch(typed.type):
        yield _refused(key, f"of type {typed.type}, and {maker} makes it a number", typed, use, here)
    elif typed is not None and use.constant and (wanted := describe_type(_written(use), typed.type)):
        place, notes = _places(key, typed, use, here)
        yield diagnostic(
            "BT233", place, notes, None, text=use.constant, port=typed.port, id=typed.node.id, wanted=wanted
        )
    elif (typed is None or typed.type not in _SCALARS) and not any(map(_may_have_type, own)):
        first = next(one for one in own if _is_value(one))
        if first.type == TEXT if use.type == NUMBER else first.type == NUMBER and not _may_be_number(use.constant):
            yield _refused(key, f"a {first.type}, and {maker} makes it a {use.type}", first, use, here)


def _wrong_in_subtree(node: Node, inner: Mapping[str, Sequence[EntryUse]]) -> Iterator[Diagnostic]:
    """Report values in a tree that constants of its SubTree node can't become: these have types since 4.9."""
    for port, text in node.ports:
        if port in inner and text and "{" not in text:
            kind = TEXT if isinstance(literal(text), str) else NUMBER
            given = EntryUse(node, port, port, type=kind, constant=text)
            values = (use for use in inner[port] if _is_value(use))
            yield from islice((problem for use in values for problem in _wrong_value(port, [given], use, given)), 1)


def _refused(key: str, reason: str, before: EntryUse, use: EntryUse, here: EntryUse) -> Diagnostic:
    place, notes = _places(key, before, use, here)
    return diagnostic("BT132", place, notes, None, id=here.node.id, reason=f"'{key}' is {reason}")


def _places(key: str, before: EntryUse, use: EntryUse, here: EntryUse) -> tuple[Span, tuple[tuple[Span, str], ...]]:
    """Return the place of a problem, and the notes that say where the types come from."""
    notes = [(attribute_value(before.node, before.port), f"here '{key}' gets its type")]
    if use.node is not here.node:
        kind = f"a {use.type}" if _is_value(use) else f"of type {use.type}"
        notes.append((attribute_value(use.node, use.port), f"here it is {kind}"))
    return attribute_value(here.node, here.port), tuple(notes)


def _is_value(use: EntryUse) -> bool:
    return use.type in (NUMBER, TEXT)


def _may_have_type(use: EntryUse) -> bool:
    """Return whether a port may give its entry a type, and which isn't known."""
    return not use.type and (use.node.id == SUBTREE or use.node.id not in CATALOGUE)


def _written(use: EntryUse) -> str:
    """Return a constant as ports have it: a whole number of a script without decimals."""
    constant = use.constant or ""
    return as_text(float(int(constant, 0) if constant[:2] in _HEX else constant)) if use.type == NUMBER else constant


def _may_be_number(text: str | None) -> bool:
    """Return whether a text may stand for a number: it isn't known, it looks like one, or like the name of an enum."""
    return text is None or text in BOOLEANS or text.isupper() or not isinstance(literal(text), str)


def _content(type: str) -> str:
    """Return the type of what is in a list, "-" if the type is none."""
    return match[1].strip() if (match := _LIST.fullmatch(type)) else "-"


def _differ(first: str, later: str) -> bool:
    """Return whether two types surely differ, the first of which isn't a text, from which everything can be read."""
    first, later = _SAME.get(first, first), _SAME.get(later, later)
    if _content(first) == later or _content(later) == first:
        return True
    if first in (later, _TEXT) or not (_is_plain(first) or _is_plain(later)):
        return False  # two lists may be one type that is written in two ways
    return all(type == _TEXT or _is_plain(type) or _LIST.fullmatch(type) for type in (first, later))


def _is_plain(type: str) -> bool:
    """Return whether a type is a number or a message, which is written in one way only."""
    return type in _SCALARS or _MESSAGE.fullmatch(type) is not None

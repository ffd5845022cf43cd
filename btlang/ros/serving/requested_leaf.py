"""The leaf that a goal asks for. Imports no interfaces."""

from __future__ import annotations

import math
from collections.abc import Sequence

from btlang.engine.instance import blackboard_key
from btlang.engine.leaves.leaf import ActionFailed
from btlang.text.spelling import nearest
from btlang.tree.node import Node
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import ValueType, format_number

_FEW = 8  # names that a reason lists


def make_leaf(
    phrase: str, names: Sequence[str], values: Sequence[str], entries: Sequence[Entry], vocabulary: Lexicon
) -> Node:
    """Return the leaf that a goal requests, of an action whose entries have the same id.

    `phrase` is one of their patterns, the id or "". Values are written as in a mission; a plain number is in the unit
    whose factor is 1. Raises ActionFailed with a reason for people.
    """
    node_id = entries[0].id
    patterns = [pattern for entry in entries for pattern in entry.phrases]
    if phrase.strip().lower() not in ("", node_id.lower(), *(pattern.lower() for pattern in patterns)):
        raise ActionFailed(f"'{phrase}' isn't served here: this is {node_id}, with the phrase '{patterns[0]}'")
    if len(names) != len(values):
        raise ActionFailed(f"{_count(len(names), 'name')} and {_count(len(values), 'value')} are given")
    types = {slot.name: vocabulary.types[slot.type] for entry in entries for slot in entry.slots}
    ports: dict[str, str] = {}
    for name, value in zip(names, values, strict=True):
        if name not in types:
            known = f"its parameters are {', '.join(types)}" if types else "it has no parameters"
            raise ActionFailed(f"{node_id} has no parameter '{name}': {known}")
        if name in ports:
            raise ActionFailed(f"{name} is given twice")
        ports[name] = _port_text(name, value, types[name], vocabulary)
    return Node(node_id, ports=tuple(ports.items()))


def _port_text(name: str, written: str, kind: ValueType, vocabulary: Lexicon) -> str:
    if blackboard_key(name, written) is not None:
        raise ActionFailed(f"{name} is '{written}', a value of a mission, but there is no mission here")
    if kind.kind == "text":
        return written
    found = vocabulary.value(kind.name, written)
    if found is None and kind.kind in ("quantity", "number"):
        found = _number(written, kind)
    if found is None:
        raise ActionFailed(f"{name} is '{written}', which isn't a {kind.name}{_instead(written, kind, vocabulary)}")
    return found


def _number(written: str, kind: ValueType) -> str | None:
    try:
        number = float(written)
    except ValueError:
        return None
    too_small = kind.least is not None and number < kind.least
    if not math.isfinite(number) or too_small or (kind.whole and number != int(number)):
        return None
    return format_number(number)


def _instead(written: str, kind: ValueType, vocabulary: Lexicon) -> str:
    if kind.kind != "names":
        return f", such as {kind.example}"
    known = vocabulary.values.names(kind.name)
    near = nearest(written.lower(), known, 1)
    if near:
        return f"; similar: {near[0]}"
    return f"; there are {', '.join(known[:_FEW])}{', ...' * (len(known) > _FEW)}" if known else ""


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"

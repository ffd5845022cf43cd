"""Values of a node that an editor can change: arguments, counts, durations and times, and what else can be done."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from btlang.editing.syntax import Unplaced
from btlang.printer.phrase import value_of
from btlang.support.record import Record
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon


class ValuePlace(Record):
    """A place for a value of a node: its type, its port text, and the node with another one."""

    kind: str
    text: str
    filled: Callable[[str], ast.Ast]


_FIELDS: Mapping[type[ast.Ast], Sequence[tuple[str, str]]] = {
    ast.Repeat: (("rounds", "count"),),
    ast.Retry: (("attempts", "count"), ("pause", "duration")),
    **dict.fromkeys((ast.Within, ast.For, ast.UpTo, ast.Delay, ast.Wait), (("seconds", "duration"),)),
    **dict.fromkeys((ast.Every, ast.Apart), (("seconds", "duration"), ("rounds", "count"))),
    ast.Held: (("seconds", "duration"),),
    **dict.fromkeys((ast.WaitTime, ast.UntilTime, ast.ByTime), (("time", "time_of_day"),)),
}
_COUNTED = frozenset(("num_cycles", "num_attempts", "rounds", "attempts"))  # the names of counts in trees, too


def places_of(node: ast.Ast) -> dict[str, ValuePlace]:
    """Return the values that a node says or may say, by the names of ports and fields."""
    if isinstance(node, ast.Assign):
        return {node.key: ValuePlace(node.kind, node.text, partial(_with_field, node, "text"))}
    if isinstance(node, ast.Compared):
        known = {name: (node.kind, text) for name, text in node.arguments}
    elif isinstance(node, ast.Phrase):
        given = dict(node.arguments)
        known = {slot.name: (slot.type, given.get(slot.name, slot.default or "")) for slot in node.entry.slots}
    else:
        fields = _FIELDS.get(type(node), ())
        said = ((field, kind, getattr(node, field)) for field, kind in fields)
        return {
            field: ValuePlace(kind, text, partial(_with_field, node, field))
            for field, kind, text in said
            if ";" not in text  # several times of day
        }
    order = tuple(known)
    return {name: ValuePlace(*found, partial(_with_argument, node, order, name)) for name, found in known.items()}


def _with_field(node: ast.Ast, field: str, text: str) -> ast.Ast:
    return node.replace(**{field: text})  # type: ignore[no-any-return]


def _with_argument(node: ast.Phrase | ast.Compared, order: Sequence[str], name: str, text: str) -> ast.Ast:
    texts = {**dict(node.arguments), name: text}
    return node.replace(arguments=tuple((each, texts[each]) for each in order if each in texts))  # type: ignore[no-any-return]


def find_place_of_value(node: ast.Ast, port: str) -> ValuePlace:
    """Return where a node has the value of a port, which in the tree may have another name. Raises Unplaced."""
    places = places_of(node)
    if port in places:
        return places[port]
    for place in places.values():
        if isinstance(node, ast.Assign) or (type(node) in _FIELDS and (place.kind == "count") == (port in _COUNTED)):
            return place
    raise Unplaced(f"it has no value '{port}' in its words")


def values_of(node: ast.Ast, vocabulary: Lexicon) -> list[tuple[str, str, str]]:
    """Return the values that a node says: name, type, and the words of each.

    Those that the mission computes are left out.
    """
    return [
        (name, place.kind, value_of(place.text, vocabulary.types[place.kind], vocabulary))
        for name, place in places_of(node).items()
        if place.text not in ("", "-1") and "{" not in place.text
    ]


def abilities(node: ast.Ast, is_condition: bool, is_whole: bool) -> list[str]:
    """Return what may be done with a node; one `is_whole` if it is all of a mission's commands."""
    found = ["insert"]
    body = getattr(node, "body", None)
    if isinstance(node, ast.Chain) or (isinstance(body, ast.Ast) and not isinstance(node, ast.Definition)):
        found.append("inside")
    if is_whole and isinstance(node, ast.Chain):
        return [*found, "turn"]
    found += ["copy", "wrap", "name"] if not is_condition else ["copy", "wrap"]
    if not is_whole:
        found += ["delete", "move"]
    if ast.parts(node):
        found.append("unwrap")
    if is_condition or isinstance(node, ast.If | ast.While | ast.Chain):
        found.append("turn")
    return found

"""What an editor can change of a node: its values (arguments, counts, durations, times), and what else can be done."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from btlang.editing.syntax import Unplaced
from btlang.printer.phrase import value_of
from btlang.record import Record
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon


class Place(Record):
    """A value of a node: its type, its port text, and the node with another one."""

    kind: str
    text: str
    filled: Callable[[str], ast.Ast]


_FIELDS: Mapping[type[ast.Ast], Sequence[tuple[str, str]]] = {
    ast.Repeat: (("rounds", "count"),),
    ast.Retry: (("attempts", "count"), ("pause", "duration")),
    **dict.fromkeys((ast.Within, ast.For, ast.UpTo, ast.Delay, ast.Wait), (("seconds", "duration"),)),
    **dict.fromkeys((ast.Every, ast.Apart), (("seconds", "duration"), ("rounds", "count"))),
    ast.WaitUntil: (("held", "duration"),),
    **dict.fromkeys((ast.WaitTime, ast.UntilTime), (("time", "time_of_day"),)),
}
_COUNTED = frozenset(("num_cycles", "num_attempts", "rounds", "attempts"))  # the names of counts in trees, too


def valued(node: ast.Ast, port: str) -> Place:
    """Where a node has the value of a port. Raises Unplaced."""
    if isinstance(node, ast.Assign):
        return Place(node.kind, node.text, lambda text: node.replace(text=text))
    if isinstance(node, ast.Phrase | ast.Name | ast.Compared):
        arguments = dict(node.arguments)
        kinds = {slot.name: slot.type for slot in node.entry.slots} if isinstance(node, ast.Phrase) else {}
        if isinstance(node, ast.Compared):
            kinds = dict.fromkeys(arguments, node.kind)
        if port in kinds:

            def filled(text: str) -> ast.Ast:
                given = {**arguments, port: text}
                return node.replace(arguments=tuple((name, given[name]) for name in kinds if name in given))  # type: ignore[no-any-return]

            return Place(kinds[port], arguments.get(port, ""), filled)
    fields = _FIELDS.get(type(node), ())
    wanted = [(field, kind) for field, kind in fields if (kind == "count") == (port in _COUNTED)]
    if not wanted:
        raise Unplaced(f"it has no value '{port}' in its words")
    field, kind = wanted[0]
    return Place(kind, getattr(node, field), lambda text: node.replace(**{field: text}))


def values_of(node: ast.Ast, vocabulary: Lexicon) -> list[tuple[str, str, str]]:
    """The values that a node says: name, type, and the words of each. Those that the mission computes are left out."""
    found: list[tuple[str, str, str]] = []
    if isinstance(node, ast.Assign):
        found = [(node.key, node.kind, node.text)]
    elif isinstance(node, ast.Compared):
        found = [(name, node.kind, text) for name, text in node.arguments]
    elif isinstance(node, ast.Phrase):
        given = dict(node.arguments)
        found = [(slot.name, slot.type, given.get(slot.name, slot.default or "")) for slot in node.entry.slots]
    for field, kind in _FIELDS.get(type(node), ()):
        found.append((field, kind, getattr(node, field)))
    return [
        (name, kind, value_of(text, vocabulary.types[kind], vocabulary))
        for name, kind, text in found
        if text not in ("", "-1") and "{" not in text
    ]


def abilities(node: ast.Ast, is_condition: bool, is_whole: bool) -> list[str]:
    """What may be done with a node; one `is_whole` if it is all of a mission's commands."""
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

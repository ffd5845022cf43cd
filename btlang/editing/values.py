"""The values of a mission that an editor can change in place: arguments of phrases, counts, durations and times."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from btlang.editing.syntax import Unplaced
from btlang.record import Record
from btlang.tree import ast


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
_COUNTED = frozenset(("num_cycles", "num_attempts", "rounds", "attempts"))


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

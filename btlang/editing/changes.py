"""Changes of texts, and paths from a mission to its nodes, by which they are found again in a changed text."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.editing.syntax import Syntax, Unplaced
from btlang.support.record import Record
from btlang.tree import ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Path: TypeAlias = list[tuple[str, int | str | None]]


class Change(Record):
    """A change: the characters `start` to `end` (exclusive) of a text become others."""

    start: int
    end: int
    text: str


def apply_changes(text: str, changes: Iterable[Change]) -> str:
    """Return the text with the changes, which are in order and don't overlap."""
    parts: list[str] = []
    at = 0
    for change in changes:
        parts += [text[at : change.start], change.text]
        at = change.end
    return "".join((*parts, text[at:]))


def find_path(node: ast.Ast, syntax: Syntax) -> Path:
    """Return the way from a mission to a node of it; definitions go by their names, as they may stand in any order."""
    path: Path = []
    while node is not syntax.mission:
        slot = syntax.slots[id(node)]
        path.append((slot.field, node.name if isinstance(node, ast.Definition) else slot.at))
        node = slot.parent
    return path[::-1]


def find_at_path(path: Path, program: ast.Program) -> ast.Ast:
    """Return the node at the end of a way. Raises Unplaced."""
    node: ast.Ast = program
    for field, at in path:
        part = getattr(node, field, None)
        if isinstance(at, str):
            part = next((each for each in program.definitions if each.name == at), None)
        elif at is not None:
            part = part[at] if isinstance(part, tuple) and at < len(part) else None
        if not isinstance(part, ast.Ast):
            raise Unplaced("no English says it there")
        node = part
    return node


def find_place(focus: ast.Ast | None, syntax: Syntax, read: ast.Program) -> tuple[int, int]:
    """Return where something of a mission stands in its text, once it is read again; nowhere for None."""
    if focus is None:
        return 0, 0
    try:
        span = find_at_path(find_path(focus, syntax), read).span
    except (Unplaced, KeyError):
        return 0, 0
    return span.start, span.end


def find_difference(old: str, new: str) -> Change:
    """Return the smallest change that makes one text of another."""
    most = min(len(old), len(new))
    start = next((i for i in range(most) if old[i] != new[i]), most)
    end = next((i for i in range(most - start) if old[-1 - i] != new[-1 - i]), most - start)
    return Change(start, len(old) - end, new[start : len(new) - end])

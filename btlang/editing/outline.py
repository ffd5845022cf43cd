"""What a text consists of, by name: its definitions, facts, rules, commands and what it includes."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.api import Mission
from btlang.text.source import Source, Span
from btlang.tree import ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LONGEST = 80  # characters of what has no name


def outline(mission: Mission, source: Source) -> list[dict[str, Any]]:
    """Return the parts in the order of the text. Offsets are characters.

    Each has its `name`; `start` and `end` of it, `of` the whole; its `kind`: "definition", "fact", "rule", "command" or
    "include". Of XML and JSON there are only the subtrees.
    """
    named = [
        {"name": name, "start": place.start, "end": place.end, "kind": kind, "of": (whole.start, whole.end)}
        for kind, name, place, whole in _parts(mission)
        if whole.source is source
    ]
    return sorted(named, key=lambda part: part["of"][0])


def _parts(mission: Mission) -> Iterator[tuple[str, str, Span, Span]]:
    """Return the kind, the name, where that is, and the whole."""
    program = mission.syntax
    if program is None:
        for name, root in mission.tree.subtrees:
            if root.span is not None:
                yield "definition", name, root.span, root.span
        return
    for definition in program.definitions:
        yield "definition", definition.name, definition.name_span, definition.span
    for fact in program.facts:
        yield "fact", fact.name, fact.span, fact.span
    for include in program.includes:
        yield "include", include.path, include.span, include.span
    for command in _statements(program.body):
        kind = "rule" if isinstance(command, ast.Whenever) else "command"
        yield kind, _first_line(command.span.text), command.span, command.span


def _statements(body: ast.Ast | None) -> tuple[ast.Ast, ...]:
    """Return the commands that follow one another."""
    if isinstance(body, ast.Chain) and body.operator == "sequence" and not body.bracketed:
        return body.items
    return () if body is None else (body,)


def _first_line(text: str) -> str:
    line = text.partition("\n")[0].rstrip()
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 1]}…"

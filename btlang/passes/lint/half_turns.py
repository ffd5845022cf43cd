"""BT163: half turns that are counted, as most people mean whole turns by `turn around three times`."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree import ast

_ENDLESS = "-1"
_HALF, _WHOLE = "TurnAround", "TurnOnceAround"


def half_turns(compilation: Compilation) -> Iterator[Diagnostic]:
    """Among the loops of the mission and of its definitions."""
    whole = compilation.vocabulary.entry(_WHOLE)
    example = whole.example if whole is not None else ""
    for body in ast.bodies(compilation.mission) if example else ():
        for node in compilation.syntax(body):
            if (
                type(node) is ast.Repeat
                and isinstance(node.body, ast.Phrase)
                and node.body.entry.id == _HALF
                and node.rounds != _ENDLESS
            ):
                said = node.span.text
                fixed = said.replace(node.body.span.text, example, 1)
                note = diagnostic("BT163", node.span, words=said, fixed=fixed)
                yield note.replace(readings=((node.span, fixed),))

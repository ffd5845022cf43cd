"""The exception that holds everything that is wrong with an input."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.render import render


class MissionError(Exception):
    """Everything that is wrong with an input. The one exception that compiling raises.

    `diagnostics` are sorted by place; at least one of them is an error.
    """

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        self.diagnostics = in_order(diagnostics)
        super().__init__(self.diagnostics)

    def __repr__(self) -> str:
        return f"<MissionError {', '.join(d.code for d in self.diagnostics)}>"

    def __str__(self) -> str:
        return "\n\n".join(render(d) for d in self.diagnostics)


def in_order(diagnostics: list[Diagnostic]) -> list[Diagnostic]:
    """By file, place, code and text, each once."""
    unique = {(d.span.source.name, d): d for d in diagnostics}  # spans of two files may be equal
    return sorted(unique.values(), key=lambda d: (d.span.source.name, d.span.start, d.code, d.span.end, d.arguments))

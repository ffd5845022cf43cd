"""A diagnostic as plain text: place, message, the line with the words underlined, the hint."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.text.source import Span

_WIDEST = 120


def render(diagnostic: Diagnostic) -> str:
    """Several lines without a last line end:

    mission.txt:1:7: error BT013: I know no place 'labb'.
      go to labb
            ^^^^
      The nearest is: lab
    """
    severity = diagnostic.kind.severity
    lines = [
        f"{diagnostic.span.place}: {severity} {diagnostic.code}: {diagnostic.message}",
        *underlined(diagnostic.span),
    ]
    lines += [f"  {line}" for line in diagnostic.hint.splitlines()]
    for span, text in diagnostic.notes:
        lines += [f"  {span.place}: {text}", *underlined(span)]
    return "\n".join(lines)


def underlined(span: Span) -> list[str]:
    """The first line of the span with `^` under its characters; a long line is cut around them."""
    if not span.source.text:
        return []
    number, column = span.source.position(span.start)
    line = span.source.line(number)
    first = column - 1
    last = min(max(first + span.end - span.start, first + 1), max(len(line), first + 1))
    if len(line) > _WIDEST:
        cut = max(0, first - _WIDEST // 2)
        before, after = ("..." if cut else ""), ("..." if cut + _WIDEST < len(line) else "")
        line = before + line[cut : cut + _WIDEST] + after
        first, last = first - cut + len(before), min(last - cut + len(before), len(line))
    line = "".join(c if c.isprintable() else " " for c in line)
    return [f"  {line}".rstrip(), "  " + " " * first + "^" * max(1, last - first)]

"""A diagnostic as text for people: place, message, the line with the words underlined, the hint, the line mended."""

from __future__ import annotations

import re

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.text.escaping import CYAN, PLAIN, RED, YELLOW, one_line
from btlang.text.source import NOWHERE, Span

# Not by rich: `btc check` would start later by its import, more than all that it does takes.
_COLOURS = {"error": RED, "warning": YELLOW, "note": CYAN}
_WIDEST = 120


def render(diagnostic: Diagnostic, colour: bool = False) -> str:
    """Several lines without a last line end; colour changes nothing but the colour.

    mission.txt:1:7: error BT013: There's no place called 'labb'.
      go to labb then wave
            ^^^^
      Similar: lab
      Did you mean: go to lab then wave
    """
    severity = diagnostic.kind.severity
    own, noted = (_COLOURS[severity], CYAN) if colour else ("", "")
    place = one_line(diagnostic.span.place)
    if diagnostic.span.source is NOWHERE.source:
        place = "btc"
    if diagnostic.span.source.hidden:
        return f"{place}: {_painted(f'{severity} {diagnostic.code}', own)} (its text isn't shown here)"
    label = _painted(f"{severity} {diagnostic.code}:", own)
    lines = [f"{place}: {label} {diagnostic.message}", *underlined(diagnostic.span, own)]
    lines += [f"  {line}" for line in diagnostic.hint.splitlines()]
    line = mended_line(diagnostic)
    if line:
        number = diagnostic.span.source.position(diagnostic.fix[0].start)[0] if diagnostic.fix is not None else 0
        elsewhere = number != diagnostic.span.source.position(diagnostic.span.start)[0]
        lines.append(f"  Did you mean{f', in line {number}' if elsewhere else ''}: {line}")
    for span, text in diagnostic.notes:
        lines += [f"  {one_line(span.place)}: {text}", *underlined(span, noted)]
    return "\n".join(lines)


def mended_line(diagnostic: Diagnostic) -> str:
    """The line with the fix of this diagnostic alone; "" where the hint shows it already or it is long."""
    if diagnostic.fix is None or any(name == "fixed" for name, _ in diagnostic.arguments):
        return ""
    span, words = diagnostic.fix
    number, column = span.source.position(span.start)
    line = span.source.line(number)
    first, last = column - 1, column - 1 + span.end - span.start
    if last > len(line) or "\n" in words:
        return ""
    before, after = line[:first], line[last:]
    mended = _blanked(f"{before}{words}{after}".strip())
    shown = mended  # a hint that has the words together with the one before them says enough
    if before.strip():
        shown = words if span.start < diagnostic.span.start else f"{before.split()[-1]} {words}"
    is_in_hint = re.search(rf"{re.escape(shown)}(?! \.\.\.| \{{)", diagnostic.hint)  # `go to ...` doesn't show `go to`
    return "" if len(mended) > _WIDEST or is_in_hint else mended


def underlined(span: Span, colour: str = "") -> list[str]:
    """The first line of the span with `^` under its characters; a long line is cut around them."""
    if not span.source.text or span.source.hidden:
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
    marks = "^" * max(1, last - first)
    return [f"  {_blanked(line)}".rstrip(), "  " + " " * first + _painted(marks, colour)]


def _painted(text: str, colour: str) -> str:
    return f"{colour}{text}{PLAIN}" if colour else text


def _blanked(line: str) -> str:
    """One character for each, so that what is underlined stays above its marks."""
    return "".join(c if c.isprintable() else " " for c in line)

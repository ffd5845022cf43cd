"""Diagnostics for editors: as data, with the offsets of all places in the text."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.formats import to_data
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def messages(problems: Iterable[Diagnostic], source: Source) -> list[dict[str, Any]]:
    """Return the messages of `to_data`; each place has its `start` and `end`, None where it is in another text."""
    return [_message(problem, source) for problem in problems]


def offsets(span: Span | None, source: Source) -> dict[str, int | None]:
    """Return the characters of a place in a text."""
    if span is None or span.source is not source:
        return {"start": None, "end": None}
    return {"start": span.start, "end": span.end}


def _message(problem: Diagnostic, source: Source) -> dict[str, Any]:
    data = to_data(problem) | offsets(problem.span, source)
    if problem.fix is not None:
        data["fix"] |= offsets(problem.fix[0], source)
    for name, spans in (("readings", problem.readings), ("notes", problem.notes)):
        data[name] = [each | offsets(place, source) for each, (place, _) in zip(data[name], spans, strict=True)]
    return data

"""Diagnostics as data, and as a document in JSON.

The document is an array with an object for each diagnostic, in the order of `in_order`, on one line. Its keys are
those of `as_data`; docs/messages.md describes them for users. Keys may be added, none gets another meaning.
"""

from __future__ import annotations

import json
from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.errors import in_order
from btlang.text.source import Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def as_json(problems: Iterable[Diagnostic]) -> str:
    """The document, in ASCII without a line end."""
    return json.dumps([as_data(problem) for problem in in_order(list(problems))])


def as_data(problem: Diagnostic) -> dict[str, Any]:
    """The object of one diagnostic.

    - `code`, `severity` ("error", "warning" or "note"), `message`, `hint` (lines joined by line ends, "" for none);
    - `file`, `line`, `column`, `end_line`, `end_column`: where it is. Lines and columns count from 1, columns in
      characters (Unicode code points); the end is exclusive: the place just after the last character;
    - `words`: the text at that place;
    - `fix`: None, or `text` and the place whose characters it replaces;
    - `readings`: such changes, each of which leaves one of the readings that the text has;
    - `notes`: objects with a `message` and its place.
    """
    kind = problem.kind
    summary = {"code": problem.code, "severity": kind.severity, "message": problem.message, "hint": problem.hint}
    fix = None if problem.fix is None else _change(*problem.fix)
    readings = [_change(*reading) for reading in problem.readings]
    notes = [{"message": text, **_place(span)} for span, text in problem.notes]
    return {
        **summary,
        **_place(problem.span),
        "words": problem.span.text,
        "fix": fix,
        "readings": readings,
        "notes": notes,
    }


def _change(span: Span, text: str) -> dict[str, str | int]:
    return {"text": text, **_place(span)}


def _place(span: Span) -> dict[str, str | int]:
    line, column = span.source.position(span.start)
    end_line, end_column = span.source.position(span.end)
    return {
        "file": span.source.name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
    }

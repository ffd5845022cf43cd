"""Where the diagnostics of one command go: as text to standard error, or as one JSON document for programs.

The document is an array with an object for each diagnostic, in the order of `in_order`, on one line. Its keys are
those of `as_data`; docs/messages.md tells the same to users. Keys may be added, none gets another meaning.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.errors import in_order
from btlang.text.output import has_colour, show
from btlang.text.source import Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST_LINES = 8  # that are named for equal warnings
FORMATS = ("text", "json")


class Report:
    """Text is printed as it is added; JSON is held until `close` prints it all. After text, `close` points to pages.

    `on_output` puts the JSON on standard output, for a command that prints nothing else there.
    """

    def __init__(self, form: str = "text", on_output: bool = False) -> None:
        self.is_json = form == "json"
        self._on_output = on_output
        self._held: list[Diagnostic] = []

    def add(self, problems: Iterable[Diagnostic]) -> None:
        """Shows these diagnostics, with an empty line between them where it is text; equal warnings there only once."""
        problems = list(problems)
        self._held += problems
        if problems and not self.is_json:
            from btlang.diagnostics.render import render  # most missions have nothing to tell of

            colour = has_colour(sys.stderr)
            equal: dict[object, list[Diagnostic]] = {}
            for problem in problems:
                words = problem.span.text.lower()
                same = id(problem) if problem.is_error else (problem.code, words, problem.message, problem.hint)
                equal.setdefault(same, []).append(problem)
            shown = (render(first, colour) + _and_more(others) for first, *others in equal.values())
            show("\n\n".join(shown), stream=sys.stderr)

    def close(self) -> None:
        """Prints the document, `[]` where there was nothing to tell; or, below the text, where more is explained."""
        if self._held and not self.is_json:
            from btlang.diagnostics.explain import pointer

            more = pointer(problem.code for problem in self._held)
            if more:
                show(f"\n{more}", stream=sys.stderr)
        if self.is_json:
            show(as_json(self._held), stream=sys.stdout if self._on_output else sys.stderr)


def _and_more(others: list[Diagnostic]) -> str:
    """A line for warnings that are equal to the one above it."""
    if not others:
        return ""
    lines = [str(other.span.source.position(other.span.start)[0]) for other in others]
    some = ", ".join(lines[:_MOST_LINES]) + (", ..." if len(lines) > _MOST_LINES else "")
    where = f"line{'s' * (len(lines) > 1)} {some}"
    return f"\n  And {len(others)} more: {where}"


def as_json(problems: Iterable[Diagnostic]) -> str:
    """The document, in ASCII without a line end."""
    import json

    return json.dumps([as_data(problem) for problem in in_order(list(problems))])


def as_data(problem: Diagnostic) -> dict[str, Any]:
    """The object of one diagnostic.

    - `code`, `severity` ("error" or "warning"), `message`, `hint` (lines joined by line ends, "" for none);
    - `file`, `line`, `column`, `end_line`, `end_column`: where it is. Lines and columns count from 1, columns in
      characters (Unicode code points); the end is exclusive: the place just after the last character;
    - `words`: the text at that place;
    - `fix`: None, or `text` and the place whose characters it replaces;
    - `readings`: such changes, each of which leaves one of the readings that the text has;
    - `notes`: objects with a `message` and its place.
    """
    kind = problem.kind
    told = {"code": problem.code, "severity": kind.severity, "message": problem.message, "hint": problem.hint}
    fix = None if problem.fix is None else _change(*problem.fix)
    readings = [_change(*reading) for reading in problem.readings]
    notes = [{"message": text, **_place(span)} for span, text in problem.notes]
    return {
        **told,
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

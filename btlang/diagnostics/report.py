"""Where the diagnostics of one command go: as text to standard error, or as one document for programs.

The forms of the document are in data.py (json), sarif.py and github.py.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.text.output import has_colour, show

_MOST_LINES = 8  # that are named for equal warnings
FORMATS = ("text", "json")
CHECK_FORMATS = (*FORMATS, "sarif", "github")


class Report:
    """Text is printed as it is added, a document by `close`. After text, `close` points to pages.

    `on_output` puts the document on standard output, for a command that prints nothing else there. `advice` is a line
    below the text of errors.
    """

    def __init__(self, form: str = "text", on_output: bool = False) -> None:
        self._form = form
        self.is_for_programs = form != "text"
        self._on_output = on_output
        self._held: list[Diagnostic] = []
        self.advice = ""

    def add(self, problems: Iterable[Diagnostic]) -> None:
        """Shows these diagnostics, with an empty line between them where it is text; equal warnings there only once."""
        problems = list(problems)
        self._held += problems
        if problems and not self.is_for_programs:
            from btlang.diagnostics.render import render  # most missions have no diagnostics

            colour = has_colour(sys.stderr)
            equal: dict[object, list[Diagnostic]] = {}
            for problem in problems:
                words = problem.span.text.lower()
                same = id(problem) if problem.is_error else (problem.code, words, problem.message, problem.hint)
                equal.setdefault(same, []).append(problem)
            shown = (render(first, colour) + _and_more(first, others) for first, *others in equal.values())
            show("\n\n".join(shown), stream=sys.stderr)

    @property
    def has_problems(self) -> bool:
        """Whether anything but notes was reported yet."""
        return any(problem.kind.severity != "note" for problem in self._held)

    def close(self) -> None:
        """Prints the document, `[]` if there was nothing to report; or, below the text, where more is explained."""
        if self._held and not self.is_for_programs:
            from btlang.diagnostics.explain import pointer

            for more in (self.advice, pointer(problem.code for problem in self._held)):
                if more:
                    show(f"\n{more}", stream=sys.stderr)
        if self.is_for_programs:
            document = self._document()
            if document:
                show(document, stream=sys.stdout if self._on_output else sys.stderr)

    def _document(self) -> str:
        if self._form == "sarif":
            from btlang.diagnostics.sarif import as_sarif

            return as_sarif(self._held)
        if self._form == "github":
            from btlang.diagnostics.github import as_github

            return as_github(self._held)
        from btlang.diagnostics.data import as_json

        return as_json(self._held)


def _and_more(first: Diagnostic, others: list[Diagnostic]) -> str:
    """A line for warnings that are equal to one above it, in its file or in others."""
    if not others:
        return ""
    lines = [str(other.span.source.position(other.span.start)[0]) for other in others]
    what = f"line{'s' * (len(lines) > 1)} "
    if any(other.span.source.name != first.span.source.name for other in others):
        what = ""
        lines = [f"{other.span.source.name}:{line}" for other, line in zip(others, lines, strict=True)]
    some = ", ".join(lines[:_MOST_LINES]) + (", ..." if len(lines) > _MOST_LINES else "")
    return f"\n  And {len(others)} more: {what}{some}"

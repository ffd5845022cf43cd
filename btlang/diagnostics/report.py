"""Reports of commands: their diagnostics, as text or as one document for programs, and a bug in btlang itself."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic, render
from btlang.support.user_dirs import user_dir
from btlang.text.output import has_colour, show
from btlang.text.source import Source, Span

_MOST_LINES = 8  # that are named for equal warnings
FORMATS = ("text", "json")
CHECK_FORMATS = (*FORMATS, "sarif", "github")
_KNOWN = {MemoryError: "there is not enough memory for this", RecursionError: "this is nested too deep"}


class DiagnosticReport:
    """The report of one command. Text is printed as it is added, a document by `close`. After text, `close` points to
    pages.

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
        """Show these diagnostics. Text has an empty line between them, and equal warnings only once."""
        problems = list(problems)
        self._held += problems
        if problems and not self.is_for_programs:
            from btlang.diagnostics.diagnostic import render  # most missions have no diagnostics

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
        """Print the document, `[]` if there was nothing to report; or, below the text, where more is explained."""
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
            from btlang.diagnostics.formats import format_sarif

            return format_sarif(self._held)
        if self._form == "github":
            from btlang.diagnostics.formats import format_github

            return format_github(self._held)
        from btlang.diagnostics.formats import format_json

        return format_json(self._held)


def _and_more(first: Diagnostic, others: list[Diagnostic]) -> str:
    """Return a line for warnings that are equal to one above it, in its file or in others."""
    if not others:
        return ""
    lines = [str(other.span.source.position(other.span.start)[0]) for other in others]
    what = f"line{'s' * (len(lines) > 1)} "
    if any(other.span.source.name != first.span.source.name for other in others):
        what = ""
        lines = [f"{other.span.source.name}:{line}" for other, line in zip(others, lines, strict=True)]
    some = ", ".join(lines[:_MOST_LINES]) + (", ..." if len(lines) > _MOST_LINES else "")
    return f"\n  And {len(others)} more: {what}{some}"


def report_crash(error: Exception) -> str:
    """Format BT099. The traceback goes to `crash.txt` in the user's folder for states, and replaces an older one."""
    reason = _KNOWN.get(type(error)) or f"{type(error).__name__}: {error}".rstrip(": ")
    try:
        advice = f"Please report it with the file {_write_traceback(error)}."
    except OSError:
        advice = "To see where, run the command again with BTC_DEBUG=1 before it."
    return render(diagnostic("BT099", Span(Source("", "btc"), 0, 0), error=reason, advice=advice))


def _write_traceback(error: Exception) -> str:
    from traceback import format_exception

    path = os.path.join(user_dir("state"), "crash.txt")
    os.makedirs(os.path.dirname(path), 0o700, exist_ok=True)
    import platform  # takes longer to import than a short mission to read

    head = f"btlang {sys.modules['btlang'].__version__}, Python {sys.version}, {platform.platform()}\n{sys.argv}\n"
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with open(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:
        file.write(head + "".join(format_exception(error)))
    return path

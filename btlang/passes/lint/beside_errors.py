"""Warnings of the sentences before the first in which something is wrong, so that one revision can heed them, too."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.text.source import Source, Span

_LOCAL = frozenset(("BT068", "BT149", "BT170"))
"""The codes of warnings that are about one sentence, whatever the others say."""
_QUOTED = re.compile(r'"[^"\n]*"')
_SENTENCE = re.compile(r"[^.!?;\n]+(?:[.!?](?!\s)[^.!?;\n]*)*[.!?;]?")


def find_beside_errors(
    source: Source, errors: Sequence[Diagnostic], warnings_of: Callable[[Source], Sequence[Diagnostic]]
) -> list[Diagnostic]:
    """Return such warnings of a text. `warnings_of` returns those of a text, or raises MissionError."""
    wrong = [error.span for error in errors if error.is_error]
    sentences = [*_sentences(source.text)]
    broken = [(first, last) for first, last in sentences if any(first <= span.start < last for span in wrong)]
    if len(broken) in (0, len(sentences)) or any(span.source is not source for span in wrong):
        return []
    rest = source.text
    for first, last in reversed(broken):
        rest = f"{rest[:first]} {rest[last:]}"  # the same while one sentence is typed; only what is before it counts
    try:
        found = warnings_of(Source(rest, source.name))
    except MissionError:
        return []
    first = broken[0][0]  # what stands behind a sentence that isn't understood may depend on it
    return [_in_source(warning, source) for warning in found if warning.code in _LOCAL and warning.span.end <= first]


def _sentences(text: str) -> Iterator[tuple[int, int]]:
    """Yield where each sentence begins and ends; no sentence ends inside quotes."""
    masked = _QUOTED.sub(lambda quoted: "x" * len(quoted[0]), text)
    return ((found.start(), found.end()) for found in _SENTENCE.finditer(masked) if found[0].strip())


def _in_source(warning: Diagnostic, source: Source) -> Diagnostic:
    """Return a warning about the same characters of another text."""

    def moved(span: Span) -> Span:
        return Span(source, span.start, span.end)

    fix = None if warning.fix is None else (moved(warning.fix[0]), warning.fix[1])
    return warning.replace(  # type: ignore[no-any-return]
        span=moved(warning.span),
        notes=tuple((moved(span), text) for span, text in warning.notes),
        fix=fix,
        readings=tuple((moved(span), text) for span, text in warning.readings),
    )

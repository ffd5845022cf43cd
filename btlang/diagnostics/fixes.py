"""Fixes that diagnostics offer, applied to their texts: only the corrections that are certain."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Change: TypeAlias = tuple[Span, str]

_ROUNDS = 20  # a correction may show the next mistake, but no text has that many behind each other


def _find_certain(problems: Iterable[Diagnostic]) -> list[Change]:
    """Return the corrections that leave no choice."""
    return [problem.fix for problem in problems if problem.fix is not None and not problem.readings]


def apply_fixes(source: Source, problems_of: Callable[[Source], Iterable[Diagnostic]]) -> tuple[Source, int]:
    """Return the source with all such changes, and their number. Included texts stay as they are."""
    count = 0
    for _ in range(_ROUNDS):
        source, made = _apply(source, _find_certain(problems_of(source)))
        if not made:
            break
        count += made
    return source, count


def apply_fixes_together(
    sources: Sequence[Source], problems_of: Callable[[Sequence[Source]], Iterable[Diagnostic]]
) -> list[tuple[Source, int]]:
    """Return sources that are read together, with all corrections that leave no choice, and the number of each."""
    counts = [0] * len(sources)
    for _ in range(_ROUNDS):
        changes = _find_certain(problems_of(sources))
        done = [_apply(source, changes) for source in sources]
        if not any(made for _, made in done):
            break
        sources = [source for source, _ in done]
        counts = [count + made for count, (_, made) in zip(counts, done, strict=True)]
    return list(zip(sources, counts, strict=True))


def _apply(source: Source, changes: Iterable[Change]) -> tuple[Source, int]:
    """Return the source with the changes that are its own, and their number."""
    made, text, before = 0, source.text, len(source.text) + 1
    own = [change for change in changes if change[0].source.name == source.name]
    for span, words in sorted(own, key=lambda change: (change[0].start, change[0].end), reverse=True):
        if span.end <= before and text[span.start : span.end] != words:
            text, before, made = text[: span.start] + words + text[span.end :], span.start, made + 1
    return (source.with_text(text), made) if made else (source, 0)

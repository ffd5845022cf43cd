"""Signs such as `<` in place of words: a mission says comparisons in words, and here is which."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.corrections import read_again
from btlang.frontends.mission.grouping.grouping import Grouped
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    ErrorsOf: TypeAlias = Callable[[Lexer, Grouped], Iterable[Diagnostic]]

_SIGNS = {
    "<": "below", ">": "above", "<=": "at_most", "=<": "at_most", "≤": "at_most", ">=": "at_least", "=>": "at_least",
    "≥": "at_least", "=": "equal", "==": "equal",
}  # fmt: skip
_EXAMPLE = "For example: the battery is below 30%"


def explain_signs(lexer: Lexer, problems: list[Diagnostic], errors_of: ErrorsOf | None) -> list[Diagnostic]:
    """Return the problems of a text, in which signs of comparisons are said to be that (BT250).

    If the text can be read with words in their place, each sign has this correction, and what else is wrong in its
    sentence is left out: it follows from the sign. `errors_of` says what is wrong with a text that can be read.
    """
    text = lexer.text
    signs = [span for span in text.unreadable if _is_sign(span)]
    if not signs:
        return problems
    changes = [_in_words(span, text, lexer.vocabulary) for span in signs]
    is_mended = errors_of is not None and _reads(lexer, changes, errors_of)
    lines = {span.source.position(span.start)[0] for span in signs}
    found: list[Diagnostic] = []
    for problem in problems:
        if problem.span in signs:
            change, help = (changes[signs.index(problem.span)], "") if is_mended else (None, _EXAMPLE)
            found.append(diagnostic("BT250", problem.span, sign=problem.span.text, fix=change, help=help))
            continue
        is_here = problem.span.source is text.source  # and not in what the text includes
        is_beside = problem.is_error and is_here and problem.span.source.position(problem.span.start)[0] in lines
        misleads = problem.code == "BT012" and any(_ends_before(problem.span, sign) for sign in signs)
        if not (is_beside and (is_mended or misleads)):
            found.append(problem)
    return found


def _is_sign(span: Span) -> bool:
    return span.text in _SIGNS and span.source.text[span.start - 1 : span.start] != "!"


def _ends_before(span: Span, sign: Span) -> bool:
    return span.end <= sign.start and not span.source.text[span.end : sign.start].strip()


def _in_words(sign: Span, text: Words, vocabulary: Lexicon) -> tuple[Span, str]:
    """Return the words for a sign, which an `is` before it may have begun."""
    words, *others = [way.partition("{")[0].split() for way in vocabulary.comparisons[_SIGNS[sign.text]]]
    before = next((text.words[at] for at, end in reversed([*enumerate(text.ends)]) if end <= sign.start), "")
    if before == words[0]:
        longer = next((other for other in (words, *others) if other[0] == before and other[1:]), words)
        words = longer[1:] or words
    around = sign.source.text
    left = "" if around[: sign.start][-1:].isspace() else " "
    right = "" if around[sign.end :][:1].isspace() else " "
    return sign, f"{left}{' '.join(words)}{right}"


def _reads(lexer: Lexer, changes: list[tuple[Span, str]], errors_of: ErrorsOf) -> bool:
    """Whether the text has no mistake with these changes."""
    source = lexer.text.source
    edges = [0, *(edge for span, _ in changes for edge in (span.start, span.end)), len(source.text)]
    kept = [source.text[start:end] for start, end in list(pairwise(edges))[::2]]
    written = "".join(part + words for part, (_, words) in zip(kept, changes, strict=False)) + kept[-1]
    mended, grouped, faults = read_again(lexer, written)
    return not faults and not any(problem.is_error for problem in errors_of(mended, grouped))

"""BT050: sentences that two people could read in two ways, where no comma, bracket or block decides.

- `then`, `and` and `or` mixed: `A then B and C`;
- a form behind a chain: `A then B 3 times`;
- an `otherwise` that two forms could have: `if C, if D, A otherwise B`;
- an `if` behind the command of another one: `if C, A, if D, B`;
- `not` before one of two conditions: `not C or D`;
- a list beside `and`: `go to the lobby and the lab and wave`;
- `after` behind two commands: `A then B after C`;
- a number before a pace: `A 3 times every 10 s`;
- two sentences that could exclude one another: `if C, A. If D, B. Otherwise E`;
- a search for a time: `look for Alice for 5 min`;
- what follows a command that is tried: `try to A, then B`.
"""

from __future__ import annotations

import re
from bisect import bisect
from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.gaps import Gaps
from btlang.passes.lint.other_form import in_form, in_pace, in_sentences, in_time
from btlang.passes.lint.other_reading import Attachment, Readings, in_chain, in_order, is_list
from btlang.text.source import Source, Span
from btlang.tree import ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.printer.printer import Printer

_SENTENCE_END = re.compile(r"[\n;]|[.!?](?=\s)")


def two_readings(compilation: Compilation) -> Iterator[Diagnostic]:
    """At most one of each kind for each sentence: the first."""
    mission, reported = compilation.mission, set[tuple[str, int, str]]()
    warned = {warning.span for warning in compilation.warnings if warning.code == "BT050"}
    printer: Printer | None = None
    ends: dict[str, list[int]] = {}
    for root in (*mission.definitions, *([mission.body] if mission.body is not None else [])):
        source = root.span.source
        for found in _attachments(root, compilation):
            if source.name not in ends:
                ends[source.name] = _sentence_ends(source)
            key = source.name, bisect(ends[source.name], found.start), found.kind
            if key in reported:
                continue
            reported.add(key)
            printer = printer or printer_for(compilation)
            readings = found.readings()
            if readings.span not in warned and not printer.say(readings.taken).in_lines:
                yield warning_of(readings, printer)


def _attachments(root: ast.Ast, compilation: Compilation) -> Iterator[Attachment]:
    """Outer ones first, in the order of the text."""
    stack = [(root, False)]
    while stack:
        node, is_part = stack.pop()
        if isinstance(node, ast.Chain):
            items = in_order(node.items)
            if (items is not node.items or any(item.parts for item in items)) and not is_list(node):
                yield from in_chain(node, items, is_part, compilation.vocabulary)
                yield from in_sentences(node, compilation.vocabulary)
                stack += reversed(_parts(items, compilation))
            continue
        if isinstance(node, ast.If | ast.Try):
            yield from in_form(node, compilation.vocabulary)
        elif isinstance(node, ast.Every):
            yield from in_pace(node, compilation.vocabulary)
        elif isinstance(node, ast.For):
            yield from in_time(node, compilation.vocabulary)
        stack += [(part, False) for part in reversed(ast.parts(node)) if part.parts]


def _parts(items: Sequence[ast.Ast], compilation: Compilation) -> list[tuple[ast.Ast, bool]]:
    """The parts of a chain that have parts, and whether each has something beside it in its statement."""
    gaps = Gaps(items, compilation.vocabulary)
    return [
        (item, isinstance(item, ast.Chain) and not gaps.is_alone(at)) for at, item in enumerate(items) if item.parts
    ]


def _sentence_ends(source: Source) -> list[int]:
    return [match.start() for match in _SENTENCE_END.finditer(source.text)]


def printer_for(compilation: Compilation) -> Printer:
    """What says the readings of a mission."""
    from btlang.printer.mission import printer_of  # most missions have nothing to report

    return printer_of(compilation.mission, compilation.vocabulary, "all")


def warning_of(found: Readings, printer: Printer) -> Diagnostic:
    """BT050 with both readings."""
    taken, other = printer.statement(found.taken), printer.statement(found.other)
    fix = None if "\n" in found.fix[0].text else found.fix
    fixed = taken if fix is None or "\n" in found.span.text else _changed(found.span, *found.fix)
    readings = () if "\n" in found.span.text else ((found.span, fixed), (found.span, other))
    problem = diagnostic("BT050", found.span, (), fix, taken=taken, other=other, fixed=fixed)
    return problem.replace(readings=readings)  # type: ignore[no-any-return]


def _changed(span: Span, part: Span, words: str) -> str:
    text = span.source.text
    return " ".join((text[span.start : part.start] + words + text[part.end : span.end]).split())

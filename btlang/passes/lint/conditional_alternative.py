"""BT050 for `A, or B if C`: B where A fails, or B instead of A. No brackets give the second reading."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.gaps import Gaps, balanced
from btlang.passes.lint.other_reading import Readings, bracketed
from btlang.passes.lint.two_readings import printer_for, warning_of
from btlang.tree import ast


def conditional_alternative(compilation: Compilation) -> Iterator[Diagnostic]:
    """Among the alternatives of the mission and of its definitions."""
    vocabulary = compilation.vocabulary
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if not isinstance(node, ast.Chain) or node.operator != "fallback":
                continue
            last = node.items[-1]
            if not isinstance(last, ast.If) or last.otherwise is not None or last.body.span.start != last.span.start:
                continue
            gap = Gaps(node.items, vocabulary).text(len(node.items) - 2)
            if "," in gap and gap.strip(" ,").lower() in vocabulary.roles["or"]:
                yield warning_of(_readings(node, last), printer_for(compilation))


def _readings(chain: ast.Chain, last: ast.If) -> Readings:
    """`A, or B if C`: if C, B, otherwise A."""
    items = chain.items[:-1]
    before = items[0] if len(items) == 1 else chain.replace(items=items, bracketed=True)
    body, otherwise = (before, last.body) if last.negated else (last.body, before)
    other = last.replace(negated=False, body=body, otherwise=otherwise)
    return Readings(chain, other, balanced(chain.span), bracketed(last.span))

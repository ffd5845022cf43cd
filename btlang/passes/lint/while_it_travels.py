"""BT069: `and` behind a command that travels or waits, where people mean `then`: `go to the lab and look around`."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.other_reading import in_order, is_list
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.journeys import takes_its_time


def while_it_travels(compilation: Compilation) -> Iterator[Diagnostic]:
    """Of the word alone: `and also`, `meanwhile` and brackets say what is meant."""
    vocabulary = compilation.vocabulary
    joint, also, then = vocabulary.word("and"), vocabulary.word("meanwhile"), vocabulary.word("then")
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is not ast.Chain or node.operator != "parallel" or is_list(node):
                continue
            for left, right in pairwise(in_order(node.items)):
                source, start, end = left.span.source, left.span.end, right.span.start
                gap = source.text[start:end]
                if takes_its_time(left) and gap.strip(" \t,").lower() == joint and "\n" not in source.text[start:end]:
                    at = start + gap.lower().index(joint)
                    word = Span(source, at, at + len(joint))
                    span = Span(source, left.span.start, right.span.end)
                    readings = tuple((word, other) for other in (also, then))
                    both, after = (f"{left.span.text} {other} {right.span.text}" for other in (also, then))
                    problem = diagnostic("BT069", span, joint=joint, both=both, after=after)
                    yield problem.replace(readings=readings)

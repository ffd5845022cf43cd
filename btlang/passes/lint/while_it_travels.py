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
from btlang.vocabulary.lexicon import Lexicon


def while_it_travels(compilation: Compilation) -> Iterator[Diagnostic]:
    """Of the word alone: `and also`, `meanwhile` and brackets say what is meant."""
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is ast.Chain and node.operator == "parallel" and not is_list(node):
                for left, right in pairwise(in_order(node.items)):
                    if takes_its_time(left):
                        yield from _warning(left.span, right.span, compilation.vocabulary)


def _warning(left: Span, right: Span, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    source, joint = left.source, vocabulary.word("and")
    gap = source.text[left.end : right.start]
    if gap.strip(" \t,").lower() != joint or "\n" in gap:
        return
    at = left.end + gap.lower().index(joint)
    word = Span(source, at, at + len(joint))
    also, then = vocabulary.word("meanwhile"), vocabulary.word("then")
    both, after = (f"{left.text} {other} {right.text}" for other in (also, then))
    problem = diagnostic("BT069", Span(source, left.start, right.end), joint=joint, both=both, after=after)
    yield problem.replace(readings=((word, also), (word, then)))

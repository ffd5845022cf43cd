"""BT175: an `and` that means `then`, where before version 0.2 it meant at the same time.

No pass of every compilation: only `btc check` looks for it, in files.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.meanings import find_meanings
from btlang.passes.lint.allow import not_silenced
from btlang.passes.lint.other_reading import in_order, is_list
from btlang.text.source import Span
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.conjunctions import Conjunctions
from btlang.vocabulary.lexicon import Lexicon


def and_means_then_now(mission: ast.Program, vocabulary: Lexicon) -> list[Diagnostic]:
    """The first one in the text itself, unless a comment silences it or the word has another meaning there."""
    source, joint = mission.span.source, vocabulary.word("and")
    own = find_meanings(split(source, vocabulary.orthography), vocabulary).found
    if joint in own or joint in vocabulary.meanings:
        return []
    found = sorted(_found(mission, vocabulary, joint), key=lambda problem: problem.span.start)
    return not_silenced([problem for problem in found if problem.span.source is source], source, vocabulary)[:1]


def _found(mission: ast.Program, vocabulary: Lexicon, joint: str) -> Iterator[Diagnostic]:
    definitions = {definition.name: definition.body for definition in ast.all_definitions(mission)}
    conjunctions = Conjunctions(definitions, vocabulary)
    for body in ast.bodies(mission):
        for node in ast.parents_first(body):
            if type(node) is not ast.Chain or node.operator != "sequence" or is_list(node):
                continue
            for left, right in pairwise(in_order(node.items)):
                if type(right) is ast.Remember or not _joined_by(joint, left.span, right.span):
                    continue
                if conjunctions.are_independent((left, right)):
                    both = f"{_text(left)} {joint} {_text(right)} {vocabulary.word('in_parallel')}"
                    place = Span(left.span.source, left.span.start, right.span.end)
                    yield diagnostic("BT175", place, joint=joint, then=vocabulary.word("then"), both=both)


def _joined_by(joint: str, left: Span, right: Span) -> bool:
    gap = left.source.text[left.end : right.start]
    return gap.strip(" \t\n,()").lower() == joint


def _text(node: ast.Ast) -> str:
    """The words of a command, in brackets where more would join them."""
    text = node.span.text
    return f"({text})" if node.parts and not text.startswith("(") else text

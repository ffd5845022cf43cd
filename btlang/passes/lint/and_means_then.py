"""BT175: an `and` that means `then`, where before version 0.2 it meant at the same time.

No pass of every compilation: only `btc check` looks for it, in files.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
            if type(node) is ast.Chain and node.operator == "sequence" and not is_list(node):
                for items in _joined_by(joint, in_order(node.items)):
                    if conjunctions.are_independent(items):
                        yield _note(items, joint, vocabulary)


def _joined_by(joint: str, items: Sequence[ast.Ast]) -> Iterator[Sequence[ast.Ast]]:
    """Neighbours that the word joins, with the commas before it."""
    first = end = 0
    for at, (left, right) in enumerate(pairwise(items), 1):
        gap = left.span.source.text[left.span.end : right.span.start].strip(" \t,()").lower()
        if gap not in (joint, "") or type(right) is ast.Remember:  # `and remember` meant `then` before
            if end > first:
                yield items[first:end]
            first = at
        elif gap == joint:
            end = at + 1
    if end > first:
        yield items[first:end]


def _note(items: Sequence[ast.Ast], joint: str, vocabulary: Lexicon) -> Diagnostic:
    first, last = items[0].span, items[-1].span
    place = Span(first.source, first.start, last.end)
    words = place.text
    if items[-1].parts and last.text[:1] != "(":  # what would join more
        words = f"{words[: last.start - first.start]}({last.text})"
    both, then = f"{words} {vocabulary.word('in_parallel')}", vocabulary.word("then")
    return diagnostic("BT175", place, joint=joint, then=then, both=both)

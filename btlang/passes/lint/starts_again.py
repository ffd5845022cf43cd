"""BT170: `A until C` behind one command that comes to an end by itself: `go to the lab until someone is near`."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon

_ENDS = frozenset(("place", "object", "person", "door", "length", "angle", "text"))
"""The types of the values with which people say when a command has ended."""


def starts_again(compilation: Compilation) -> Iterator[Diagnostic]:
    """Not where `repeat`, `keep` or a form before the command says that it is repeated."""
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is ast.While and node.otherwise is None and _has_an_end(node.body):
                yield from _warning(node, compilation.vocabulary)


def _has_an_end(command: ast.Ast) -> bool:
    if type(command) is not ast.Phrase:
        return False
    said = {slot for slot, _ in command.arguments}
    return any(slot.name in said and slot.type in _ENDS for slot in command.entry.slots)


def _warning(node: ast.While, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    text, command = node.span.source.text, node.body.span
    between = text[command.end : node.condition.span.start]
    words = vocabulary.orthography.words(between.strip(" \t,("))
    role = "until" if node.negated else "while"
    if command.start != node.span.start or " ".join(words) not in vocabulary.roles[role]:
        return
    behind = text[command.end : node.span.end].strip(" \t,")
    condition = behind.split(maxsplit=len(words))[-1]
    said = command.text[0].lower() + command.text[1:]
    again = f"{vocabulary.word('repeat')} {said} {behind}"
    once = f"{command.text} {vocabulary.word('stop_when' if node.negated else 'provided')} {condition}"
    problem = diagnostic("BT170", node.span, words=command.text, again=again, once=once)
    yield problem.replace(readings=((node.span, again), (node.span, once)))

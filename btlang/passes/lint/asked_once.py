"""BT068: conditions that are asked only once, where people expect the robot to keep an eye on them.

`When C, A` as a whole statement, and `stop when C`, which can stop nothing: the commands before it have ended.
"""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import Span
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon


def asked_once(compilation: Compilation) -> Iterator[Diagnostic]:
    """Among the statements of the mission, of definitions and of blocks."""
    vocabulary = compilation.vocabulary
    for body in ast.bodies(compilation.mission):
        before: dict[int, ast.Ast] = {}
        for node in compilation.syntax(body):
            if type(node) is ast.Chain and node.operator == "sequence":
                before.update((id(item), other) for other, item in zip(node.items, node.items[1:], strict=False))
            if type(node) is ast.If and not node.negated and node.otherwise is None and _is_statement(node):
                yield from _warning(node, before.get(id(node)), vocabulary)


def _is_statement(node: ast.If) -> bool:
    """Whether nothing stands beside it in its statement, and no block below it."""
    text, span = node.span.source.text, node.span
    before, behind = text[: span.start].rstrip(" \t"), text[span.end :].lstrip(" \t")
    starts = not before or before[-1] in "\n;.!?"
    return starts and "\n" not in span.text and (not behind or behind[0] in "\r\n;.!?#")


def _warning(node: ast.If, before: ast.Ast | None, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    source, condition = node.span.source, node.condition.span
    if node.body.span.start < condition.start:
        if before is not None and node.body.span.text.lower() in vocabulary.halting and "\n" not in before.span.text:
            fixed = f"{before.span.text} {vocabulary.word('stop_when')} {condition.text}"
            advice = f"To stop what comes before, write: {fixed}"
            reading = Span(source, before.span.start, node.span.end), fixed
            yield diagnostic("BT068", node.span, words=node.span.text, advice=advice).replace(readings=(reading,))
        return
    word = next(iter(source.text[node.span.start : condition.start].split(maxsplit=1)), "")  # none before a question
    if word.lower() in vocabulary.asked_once:
        rest = source.text[node.span.start + len(word) : node.span.end].lstrip()
        once, each = (f"{vocabulary.word(role)} {rest}" for role in ("as_soon_as", "whenever"))
        advice, other = f"To wait until it is true, write: {once}", f"To do it each time, write: {each}"
        readings = (node.span, once), (node.span, each)
        words = f"{word} {condition.text}"
        yield diagnostic("BT068", node.span, words=words, advice=advice, help=other).replace(readings=readings)

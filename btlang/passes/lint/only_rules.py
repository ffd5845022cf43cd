"""BT173: a name whose body is only rules, beside other commands: it watches for ever, and they don't run meanwhile."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.other_reading import in_order
from btlang.text.source import Span
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon


def only_rules(compilation: Compilation) -> Iterator[Diagnostic]:
    """In sequences: beside the parts of a Parallel such a name ends with them."""
    names = {each.name for each in ast.all_definitions(compilation.mission) if _is_only_rules(each.body)}
    if not names:
        return
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is ast.Chain and node.operator == "sequence":
                items = in_order(node.items)
                for at, item in enumerate(items):
                    if type(item) is ast.Name and item.name in names:
                        beside = items[at + 1] if at + 1 < len(items) else items[at - 1]
                        yield _warning(item, beside, compilation.vocabulary)


def _is_only_rules(body: ast.Ast) -> bool:
    items = body.items if type(body) is ast.Chain and body.operator == "sequence" else (body,)
    return all(type(item) is ast.Whenever for item in items)


def _warning(rules: ast.Name, beside: ast.Ast, vocabulary: Lexicon) -> Diagnostic:
    words, other = rules.span.text, beside.span.text
    is_block = "\n" in other
    fixed = f"{'...' if is_block else other}, {vocabulary.word('meanwhile')} {words}"
    problem = diagnostic("BT173", rules.span, words=words, fixed=fixed)
    if is_block:
        return problem
    start, end = min(rules.span.start, beside.span.start), max(rules.span.end, beside.span.end)
    return problem.replace(readings=((Span(rules.span.source, start, end), fixed),))  # type: ignore[no-any-return]

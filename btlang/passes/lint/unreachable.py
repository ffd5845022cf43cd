"""BT052: commands that never run, because what is before them never lets the mission come to them."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.endings import NEVER, Ends, ends_of, going_on
from btlang.text.source import Span
from btlang.tree.catalogue import CATALOGUE, ON_SUCCESS, NodeKind
from btlang.tree.node import Node


def never_runs(compilation: Compilation) -> list[Diagnostic]:
    """The first such command of each node whose children follow in order."""
    found: list[Diagnostic] = []

    def combine(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
        kind = CATALOGUE.get(node.id)
        if kind is not None and kind.goes_on and not kind.rotates:
            wanted = going_on(kind)
            for at in range(len(children) - 1):
                if not children[at] & wanted:
                    found.extend(_warnings(kind, node.children[at], children[at], node.children[at + 1]))
                    break
        return ends_of(node, children, named)

    compilation.fold(combine)
    return found


def _warnings(parent: NodeKind, before: Node, ends: Ends, behind: Node) -> list[Diagnostic]:
    """Nothing where both stand for the same words: then a form has put one of them there."""
    if before.span is None or behind.span is None or _overlap(before.span, behind.span):
        return []
    if ends & NEVER:
        how = "fails" if parent.goes_on == ON_SUCCESS else "succeeds"
        reason = "never ends" if ends == NEVER else f"continues until it {how}"
    else:
        reason = "always fails" if parent.goes_on == ON_SUCCESS else "always succeeds"
    return [diagnostic("BT052", behind.span, ((before.span, f"this {reason}"),), reason=reason)]


def _overlap(first: Span, second: Span) -> bool:
    return first.source is second.source and first.start < second.end and second.start < first.end

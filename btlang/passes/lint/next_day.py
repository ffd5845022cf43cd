"""BT169: a time of day that is waited for behind commands that end at that time: `A until 5 pm. At 5 pm, B`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree import ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def next_day(compilation: Compilation) -> Iterator[Diagnostic]:
    """Among commands one after the other, in the mission and in definitions."""
    for body in ast.bodies(compilation.mission):
        nodes = compilation.syntax(body)
        if not any(isinstance(node, ast.WaitTime) for node in nodes):
            continue
        waits, ends = _first(nodes, ast.WaitTime), _first(nodes, ast.UntilTime | ast.WaitTime)
        for node in nodes:
            if type(node) is not ast.Chain or node.operator != "sequence":
                continue
            ended = ""
            for item in node.items:
                wait = waits.get(id(item))
                if wait is not None and ended and ended in wait.time.split(";"):
                    yield diagnostic("BT169", wait.span, words=wait.span.text)
                if isinstance(item, ast.Whenever):
                    continue
                end = ends.get(id(item))
                ended = "" if end is None else end.time


def _first(nodes: Sequence[ast.Ast], kinds: Any) -> dict[int, Any]:
    """By the id of each node of a tree, parents first: the first one of these kinds in it, where it has one."""
    found: dict[int, Any] = {}
    for node in reversed(nodes):
        parts = (found[id(part)] for part in ast.parts(node) if id(part) in found)
        first = node if isinstance(node, kinds) else next(parts, None)
        if first is not None:
            found[id(node)] = first
    return found

"""BT169: a time of day that is waited for behind commands that end at that time: `A until 5 pm. At 5 pm, B`."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree import ast


def next_day(compilation: Compilation) -> Iterator[Diagnostic]:
    """Among commands one after the other, in the mission and in definitions."""
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is not ast.Chain or node.operator != "sequence":
                continue
            ended = ""
            for item in node.items:
                wait = next((each for each in ast.parents_first(item) if isinstance(each, ast.WaitTime)), None)
                if wait is not None and ended and ended in wait.time.split(";"):
                    yield diagnostic("BT169", wait.span, words=wait.span.text)
                if isinstance(item, ast.Whenever):
                    continue
                ends = (each.time for each in ast.parents_first(item) if isinstance(each, ast.UntilTime | ast.WaitTime))
                ended = next(ends, "")

"""Commands that travel or wait: people often mean `then` by an `and` behind them."""

from __future__ import annotations

from btlang.tree import ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_WAITING = (ast.Wait, ast.WaitUntil, ast.WaitTime)


def takes_its_time(node: ast.Ast) -> bool:
    """Whether the command, or each of the commands of a list, navigates or waits, also with forms around it."""
    inner: Any = node
    while getattr(inner, "body", None) is not None and not isinstance(inner, ast.Whenever):
        inner = inner.body
    if isinstance(inner, ast.Chain) and inner.items:
        inner = inner.items[-1]
    return isinstance(inner, _WAITING) or (isinstance(inner, ast.Phrase) and "navigation" in inner.entry.needs)

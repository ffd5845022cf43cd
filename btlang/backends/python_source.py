"""Python source of trees: expressions that no parser of Python finds too deep."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence

from btlang.support.record import Record
from btlang.tree.node import Node
from btlang.tree.visit import fold

_WIDEST = 110  # columns
_DEEPEST = 20  # calls in each other; what is deeper becomes statements of its own
_INDENT = "    "


class Source(Record):
    """An expression as lines, and how many calls stand in each other in it."""

    lines: tuple[str, ...]
    depth: int


class Statements:
    """Collects the statements that must stand before an expression: `part_1 = ...`."""

    def __init__(self, prefix: str = "part_") -> None:
        self.lines: list[str] = []
        self._prefix = prefix
        self._count = 0

    def expression(self, root: Node, call: Callable[[Node, list[Source]], Source]) -> Source:
        """The expression of a tree; `call` makes that of a node from those of its children."""

        def combine(node: Node, children: list[Source]) -> Source:
            return self.named_if_deep(call(node, children))

        return fold(root, lambda node: node.children, combine)

    def named_if_deep(self, made: Source) -> Source:
        """The expression, or the name that a statement gives it."""
        if made.depth < _DEEPEST:
            return made
        self._count += 1
        name = f"{self._prefix}{self._count}"
        self.lines += [f"{name} = {made.lines[0]}", *made.lines[1:]]
        return Source((name,), 0)


def called(function: str, arguments: Sequence[str | Source], brackets: str = "()") -> Source:
    """A call, or with an empty `function` a tuple or list: on one line where it fits, else an argument a line."""
    depth = 1 + max((argument.depth for argument in arguments if isinstance(argument, Source)), default=0)
    texts = [(argument,) if isinstance(argument, str) else argument.lines for argument in arguments]
    comma = "," if not function and len(texts) == 1 and brackets == "()" else ""
    line = f"{function}{brackets[0]}{', '.join(text[0] for text in texts)}{comma}{brackets[1]}"
    if all(len(text) == 1 for text in texts) and len(line) + depth * len(_INDENT) <= _WIDEST:
        return Source((line,), depth)
    lines = [f"{function}{brackets[0]}"]
    for text in texts:
        lines += [_INDENT + part for part in text]
        lines[-1] += ","
    return Source((*lines, brackets[1]), depth)


def literal(value: object) -> str:
    """A text, number, None, or list or tuple of them, with texts in double quotes."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)  # Python knows all escapes of JSON
    if isinstance(value, list):
        return f"[{', '.join(map(literal, value))}]"
    if isinstance(value, tuple):
        return f"({', '.join(map(literal, value))}{',' if len(value) == 1 else ''})"
    return repr(value)

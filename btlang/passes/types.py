"""Port values: each text must be a value of the type that its port is declared with."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import Span
from btlang.tree.catalogue import CATALOGUE, Port
from btlang.tree.node import Node


def check_types(compilation: Compilation) -> Iterator[Diagnostic]:
    """BT014 for whole numbers, such as times and numbers of rounds, that a tree cannot hold."""
    for _, nodes in compilation.nodes:
        wrong = {id(node): wanted for node in nodes if node.ports and (wanted := _out_of_range(node))}
        for node, span in _with_spans(nodes[-1]) if wrong else ():
            if span is not None and id(node) in wrong:
                yield diagnostic("BT014", span, words=node.replace(span=span).source_text, wanted=wrong[id(node)])


def _with_spans(root: Node) -> Iterator[tuple[Node, Span | None]]:
    """Every node with its words, or those around it: the timer of `for` has no words of its own."""
    stack = [(root, root.span)]
    while stack:
        node, span = stack.pop()
        span = node.span or span
        yield node, span
        stack.extend((child, span) for child in node.children)


def _out_of_range(node: Node) -> str:
    """What would be in range, "" where all is."""
    kind = CATALOGUE.get(node.id)
    if kind is None:
        return ""
    for name, text in node.ports:
        port = kind.ports.get(name)
        if port is None or port.least is None or port.most is None or not text or "{" in text:
            continue  # not given, which is another mistake, or only known when it runs
        try:
            number = int(text)
        except ValueError:
            return f"{name} is a whole number, not {text!r}"
        if kind.interrupts and number == 0:
            return "a time limit is at least 0.001 s"  # 0 would mean no limit
        if not port.least <= number <= port.most:
            return _wanted(port, name, number)
    return ""


def _wanted(port: Port, name: str, number: int) -> str:
    if port.unit == "ms":
        return "a time is not negative" if number < 0 else "a time is at most 49 days"
    if port.unit == "rounds" and number > 0:
        return f"a number of rounds is at most {port.most:,}"
    return f"{name} is a whole number from {port.least} to {port.most}"

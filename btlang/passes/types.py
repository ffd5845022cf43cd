"""Port values: each text must be a value of the type that its port is declared with."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.text.source import Span
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first
from btlang.vocabulary.vocabulary import Vocabulary

_TIMES = {"Timeout": "msec", "Delay": "delay_msec", "Sleep": "msec"}
_COUNTS = {"Repeat": "num_cycles", "RetryUntilSuccessful": "num_attempts"}
_LIMITED = {**_TIMES, **_COUNTS}
_LONGEST = 2**32 - 1  # BehaviorTree.CPP holds milliseconds in an unsigned int
_MOST = 2**31 - 1  # and rounds in an int


def check_types(tree: Tree, _vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    """BT014 for times and numbers of rounds that a tree cannot hold."""
    for root in (tree.root, *(node for _, node in tree.subtrees)):
        limited = [node for node in children_first(root) if node.id in _LIMITED]
        wrong = {id(node): wanted for node in limited if (wanted := _out_of_range(node))}
        for node, span in _with_spans(root) if wrong else ():
            if span is not None and id(node) in wrong:
                yield diagnostic("BT014", span, words=span.text, wanted=wrong[id(node)])


def _with_spans(root: Node) -> Iterator[tuple[Node, Span | None]]:
    """Every node with its words, or those around it: the timer of `for` has no words of its own."""
    stack = [(root, root.span)]
    while stack:
        node, span = stack.pop()
        span = node.span or span
        yield node, span
        stack.extend((child, span) for child in node.children)


def _out_of_range(node: Node) -> str:
    """What would be in range, "" where it is."""
    text = node.port(_LIMITED[node.id])
    if not text or "{" in text:
        return ""  # not given, which is another mistake, or only known when it runs
    try:
        number = int(text)
    except ValueError:
        return f"{_LIMITED[node.id]} is a whole number, not {text!r}"
    if node.id in _TIMES and number > _LONGEST:
        return "a time is at most 49 days"
    if node.id in _TIMES and number < 0:
        return "a time is not negative"
    if node.id == "Timeout" and number == 0:
        return "a time limit is at least 0.001 s"  # 0 would mean no limit
    if node.id in _COUNTS and number > _MOST:
        return f"a number of rounds is at most {_MOST:,}"
    return ""

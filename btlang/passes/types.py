"""Port values: each text must be a value of the type that its port is declared with."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.tree.node import Tree
from btlang.vocabulary.vocabulary import Vocabulary

_TIMES = {"Timeout": "msec", "Delay": "delay_msec", "Sleep": "msec"}
_LONGEST = 2**32 - 1  # BehaviorTree.CPP holds milliseconds in an unsigned int


def check_types(tree: Tree, _vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    """BT014 for times that a tree cannot hold."""
    for root in (tree.root, *(node for _, node in tree.subtrees)):
        stack = [(root, root.span)]
        while stack:
            node, span = stack.pop()
            span = node.span or span  # the timer of `for` has no words of its own
            port = _TIMES.get(node.id)
            if port is not None and not 0 <= int(node.port(port)) <= _LONGEST and span is not None:
                yield diagnostic("BT014", span, words=span.text, wanted="a time is at most 49 days")
            stack.extend((child, span) for child in node.children)

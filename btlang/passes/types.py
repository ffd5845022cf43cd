"""Port values: each text must be a value of the type that its port is declared with."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.tree.node import Node, Tree
from btlang.vocabulary.vocabulary import Vocabulary

_TIMES = {"Timeout": "msec", "Delay": "delay_msec", "Sleep": "msec"}
_COUNTS = {"Repeat": "num_cycles", "RetryUntilSuccessful": "num_attempts"}
_LONGEST = 2**32 - 1  # BehaviorTree.CPP holds milliseconds in an unsigned int
_MOST = 2**31 - 1  # and rounds in an int


def check_types(tree: Tree, _vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    """BT014 for times and numbers of rounds that a tree cannot hold."""
    for root in (tree.root, *(node for _, node in tree.subtrees)):
        stack = [(root, root.span)]
        while stack:
            node, span = stack.pop()
            span = node.span or span  # the timer of `for` has no words of its own
            wanted = _out_of_range(node)
            if wanted and span is not None:
                yield diagnostic("BT014", span, words=span.text, wanted=wanted)
            stack.extend((child, span) for child in node.children)


def _out_of_range(node: Node) -> str:
    """What would be in range, "" where it is."""
    if "{" in node.port(_TIMES.get(node.id, _COUNTS.get(node.id, ""))):
        return ""  # only known when it runs
    if node.id in _TIMES and int(node.port(_TIMES[node.id])) > _LONGEST:
        return "a time is at most 49 days"
    if node.id == "Timeout" and int(node.port("msec")) == 0:
        return "a time limit is at least 0.001 s"  # 0 would mean no limit
    if node.id in _COUNTS and int(node.port(_COUNTS[node.id])) > _MOST:
        return f"a number of rounds is at most {_MOST:,}"
    return ""

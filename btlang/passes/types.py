"""Port values: each text must be a value of the type that its port is declared with."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.tree.node import Node, Tree
from btlang.vocabulary.vocabulary import Vocabulary

_TIMES = {"Timeout": "msec", "Delay": "delay_msec", "Sleep": "msec"}
_LONGEST = 2**32 - 1  # BehaviorTree.CPP holds milliseconds in an unsigned int


def check_types(tree: Tree, _vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    """BT014 for times that a tree cannot hold."""
    for node in tree.walk():
        port = _TIMES.get(node.id)
        if port is not None and not 0 <= int(node.port(port)) <= _LONGEST:
            yield _out_of_range(node)


def _out_of_range(node: Node) -> Diagnostic:
    assert node.span is not None
    return diagnostic("BT014", node.span, words=node.span.text, wanted="a time is at most 49 days")

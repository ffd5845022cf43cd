"""BT053: loops without end whose rounds take no time, so that they go round at every tick and do nothing but that."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.lint.subject import Subject, fold_tree
from btlang.tree.node import Node
from btlang.vocabulary.entry import Entry

ASKS, INSTANT, TAKES_TIME = range(3)
"""What the leaves below a node are at most: conditions, things that end in the tick they start, others."""

_LOOPS = {"Repeat": "num_cycles", "RetryUntilSuccessful": "num_attempts"}
_WAITING = frozenset(("Sleep", "Delay"))


def busy_loops(subject: Subject) -> list[Diagnostic]:
    """Loops with no leaf that takes time. `wait until C` asks again and again, too, but that is what it is for."""
    busy: list[Node] = []
    entries = subject.vocabulary.entries

    def combine(node: Node, children: Sequence[int], named: dict[str, int]) -> int:
        if not children:
            if node.id == "SubTree":
                return named.get(node.port("ID"), TAKES_TIME)
            if node.id in _WAITING:
                return TAKES_TIME
            return _leaf(entries[node.id][0]) if node.id in entries else INSTANT
        if node.id == "Parallel" and node.port("success_count") == "1":
            while busy and any(child is busy[-1] for child in node.children):
                busy.pop()  # the loop of `for 5 s` has an end
            return TAKES_TIME
        if node.id in _WAITING:
            return TAKES_TIME
        most = max(children)
        if most == TAKES_TIME or node.id not in _LOOPS or node.port(_LOOPS[node.id]) != "-1":
            return most
        if node.id == "RetryUntilSuccessful" and most == ASKS:
            return TAKES_TIME
        busy.append(node)
        return most

    fold_tree(subject.tree, combine)
    word = subject.vocabulary.word
    advice = f"To wait for a condition say '{word('wait_until')} ...'; else put a '{word('wait')}' into the loop."
    return [diagnostic("BT053", node.span, advice=advice) for node in busy if node.span is not None]


def _leaf(entry: Entry) -> int:
    """What is in no keyword file is a node of the tree itself, such as a script: that is INSTANT, too."""
    if entry.instant:
        return INSTANT
    return TAKES_TIME if entry.sort == "action" else ASKS

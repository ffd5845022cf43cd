"""BT053: loops without end whose rounds take no time, so that they go round at every tick and do nothing but that."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree.catalogue import CATALOGUE, ON_FAILURE, SUBTREE
from btlang.tree.node import Node
from btlang.vocabulary.entry import Entry

ASKS, INSTANT, TAKES_TIME = range(3)
"""What the leaves below a node are at most: conditions, things that end in the tick they start, others."""


def busy_loops(compilation: Compilation) -> list[Diagnostic]:
    """Loops with no leaf that takes time. `wait until C` asks again and again, too, but that is what it is for."""
    busy: list[Node] = []
    entries = compilation.vocabulary.entries

    def combine(node: Node, children: Sequence[int], named: dict[str, int]) -> int:
        kind = CATALOGUE.get(node.id)
        if not children:
            if node.id == SUBTREE:
                return named.get(node.port("ID"), TAKES_TIME)
            if kind is not None:
                return TAKES_TIME if kind.takes_time else ASKS if kind.kind == "Condition" else INSTANT
            return _leaf(entries[node.id][0]) if node.id in entries else TAKES_TIME
        if kind is not None and kind.enough and node.port(kind.enough) == "1":
            while busy and any(child is busy[-1] for child in node.children):
                busy.pop()  # the loop of `for 5 s` has an end
            return TAKES_TIME
        if kind is not None and kind.roles[-1:] == ("work",):
            children = children[:2]  # what it does is to watch
            while busy and busy[-1] is node.children[2]:
                busy.pop()
        most = max(children)
        if kind is None or most == TAKES_TIME or not kind.again or not kind.is_endless(node.ports):
            return TAKES_TIME if kind is None or kind.takes_time else most
        if most == ASKS and (kind.again == ON_FAILURE or not kind.rounds):
            return TAKES_TIME  # it waits for a condition to become true, or false
        busy.append(node)
        return most

    if any(id in CATALOGUE and CATALOGUE[id].again for id in compilation.ids):
        compilation.fold(combine)
    word = compilation.vocabulary.word
    advice = f"To wait for a condition, say '{word('wait_until')} ...'; otherwise add a '{word('wait')}' to the loop."
    if not compilation.is_text:
        advice = "Add something that takes time, such as a Sleep node."
    return [diagnostic("BT053", node.span, advice=advice) for node in busy if node.span is not None]


def _leaf(entry: Entry) -> int:
    if entry.outputs and not entry.phrases:
        return ASKS  # it chooses what a condition is about
    if entry.instant:
        return INSTANT
    return TAKES_TIME if entry.sort == "action" else ASKS

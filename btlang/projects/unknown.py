"""BT231: nodes that neither a model nor btlang knows, each id once."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.btcpp.dialect import ONLY_IN_3
from btlang.projects.places import id_place
from btlang.projects.ports import respelling
from btlang.text.spelling import misspelt
from btlang.tree.node import Node


def unknown_nodes(
    nodes: Iterable[Node], described: Collection[str], words: Collection[str], dialects: Mapping[str, int]
) -> Iterator[Diagnostic]:
    """At the first node of each such id, with how often it is used.

    `described` are the ids that the project can mean, `words` those of btlang's leaves; `dialects` are those of files.
    """
    uses: dict[str, list[Node]] = {}
    for node in nodes:
        if node.id and node.id not in described and node.id not in words and node.span is not None:
            uses.setdefault(node.id, []).append(node)
    for node_id, found in uses.items():
        first = found[0]
        place = id_place(first)
        if node_id in ONLY_IN_3 and dialects.get(place.source.name) == 3:
            continue
        near, words_near = misspelt(node_id, described), misspelt(node_id, words)
        # a tag with an end tag can't be changed alone
        fix = None if first.children and place.text == node_id else respelling(place, near)
        times = {1: "once", 2: "twice"}.get(len(found), f"{len(found)} times")
        help = f"Similar: {', '.join(near or words_near)}" if near or words_near else ""
        yield diagnostic("BT231", place, (), fix, id=node_id, times=times, help=help)

"""The comments of a mission by the statement that they tell of: the one on their line, or else the next one."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable

from btlang.text.source import Source
from btlang.text.words import Orthography, split
from btlang.tree.node import Node

FOOT = math.inf
"""In place of a line: behind all statements."""
KEPT = "#:"
"""Begins a comment with what is kept of an XML file, for programs (see btlang.backends.btcpp.kept)."""


def line_of(node: Node) -> int:
    """The line on which a node is said, from 1; 0 for one that comes from no text."""
    return node.span.source.position(node.span.start)[0] if node.span is not None else 0


def comments_by_line(source: Source, orthography: Orthography, nodes: Iterable[Node]) -> dict[float, list[str]]:
    """The comments of a text without their marks, by the line of the statement that they tell of.

    `nodes` are those of the mission. Comments without a letter or digit are left out: they are rulers.
    """
    lines = sorted({line_of(node) for node in nodes if node.span is not None and node.span.source is source})
    found: defaultdict[float, list[str]] = defaultdict(list)
    for span in split(source, orthography).comments:
        text = " ".join(span.text[1:].split())
        if span.text.startswith(KEPT) or not any(map(str.isalnum, text)):
            continue
        line = source.position(span.start)[0]
        found[next((each for each in lines if each >= line), FOOT)].append(text)
    return dict(found)

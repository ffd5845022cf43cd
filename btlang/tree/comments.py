"""Comments of a mission by the statement that they describe: the one on their line, or else the next one."""

from __future__ import annotations

import math
from collections import defaultdict

from btlang.text.source import Source
from btlang.text.words import Orthography, split
from btlang.tree.node import Node, Tree

HEAD, FOOT = 0.0, math.inf
"""In place of a line: before the line that names the mission, and behind all statements."""
KEPT = "#:"
"""Begins a comment with what is kept of an XML file, for programs (see btlang.frontends.btcpp.kept)."""


def line_of(node: Node) -> int:
    """Return the line on which a node is said, from 1; 0 for one that comes from no text."""
    return node.span.source.position(node.span.start)[0] if node.span is not None else 0


def comments_by_line(source: Source, orthography: Orthography, tree: Tree) -> dict[float, list[str]]:
    """Return the comments of the text of a tree without their marks, by the line of the statement that they
    describe.

    Those without a letter or digit are left out: they are rulers.
    """
    lines = sorted({line_of(node) for node in tree.walk() if node.span is not None and node.span.source is source})
    words = split(source, orthography)
    named = words.starts[0] if tree.name else 0
    found: defaultdict[float, list[str]] = defaultdict(list)
    for span in words.comments:
        text = " ".join(span.text[1:].split())
        if span.text.startswith(KEPT) or not any(map(str.isalnum, text)):
            continue
        line = source.position(span.start)[0]
        place = HEAD if span.start < named else next((each for each in lines if each >= line), FOOT)
        found[place].append(text)
    return dict(found)

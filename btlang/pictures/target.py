"""The picture of a tree as a target of `btc compile`."""

from __future__ import annotations

from functools import partial

from btlang.pictures.letters import shown
from btlang.pictures.tree_boxes import Maker, title_of
from btlang.pictures.tree_picture import picture_of
from btlang.printer.phrase import phrase_of
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon


def to_svg(tree: Tree, vocabulary: Lexicon, *, title: str = "") -> str:
    """The text of an SVG file, whose `title` is by default the name of the tree's file."""
    return _drawn(tree, vocabulary, ".svg", title).decode()


def to_png(tree: Tree, vocabulary: Lexicon) -> bytes:
    """The content of a PNG file. Raises MissionError (BT081)."""
    return _drawn(tree, vocabulary, ".png")


def _drawn(tree: Tree, vocabulary: Lexicon, kind: str, title: str = "") -> bytes:
    sheets = Maker(tree, partial(_label, vocabulary), partial(_is_action, vocabulary)).sheets()
    return picture_of(sheets, shown(title) or title_of(tree), kind)


def _label(vocabulary: Lexicon, node: Node) -> str:
    return node.name or phrase_of(node, vocabulary)


def _is_action(vocabulary: Lexicon, node: Node) -> bool:
    entry = vocabulary.entry(node.id)
    return entry is not None and entry.sort == "action"

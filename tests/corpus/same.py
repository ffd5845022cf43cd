"""Whether two XML texts hold the same, and other helpers for tests of XML."""

from __future__ import annotations

from functools import cache

from btlang.backends.btcpp import to_xml
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.btcpp.scan import scanned
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.node import Tree
from btlang.vocabulary.lexicon import Lexicon


def content(text: str) -> object:
    """All elements with their attributes in order, depths, texts, comments and where these stand.

    Texts count without the space around them where they stand beside tags.
    """
    document = scanned(Source(text))
    elements = [(tag, flat, document.depths[at]) for at, (tag, flat, _, _) in enumerate(document.elements)]
    notes = [(note.text.strip() if note.is_text else note.text, note.before, note.ended) for note in document.notes]
    return elements, notes, document.declaration, document.doctype


@cache
def words() -> Lexicon:
    """The shipped words."""
    return world_vocabulary()


def written(tree: Tree, dialect: int = 4) -> str:
    """The XML of a tree."""
    return to_xml(tree, words(), dialect=dialect)


def read(text: str, name: str = "<text>") -> Tree:
    """The tree of an XML text."""
    return read_xml(Source(text, name))

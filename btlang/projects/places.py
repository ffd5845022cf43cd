"""Where in the start tag of a node its tag and attributes stand."""

from __future__ import annotations

import re

from btlang.text.source import NOWHERE, Span
from btlang.tree.node import Node

_ATTRIBUTE = re.compile(r"""([^\s"'=<>/]+)\s*=\s*("[^"]*"|'[^']*')""")


def place_of(node: Node) -> Span:
    """Its start tag."""
    return node.span or NOWHERE


def attribute_name(node: Node, port: str) -> Span:
    """The name of an attribute; the start tag where it has no such attribute."""
    return _found(node, port, 1)


def attribute_value(node: Node, port: str) -> Span:
    """The text of an attribute, without its quotes; the start tag where it has no such attribute."""
    return _found(node, port, 2)


def id_place(node: Node) -> Span:
    """What names its id: the tag, or the attribute ID behind a tag of its kind."""
    span = place_of(node)
    tag = re.match(r"<([^\s/>]+)", span.text)
    if tag is not None and tag[1] == node.id:
        return Span(span.source, span.start + 1, span.start + 1 + len(node.id))
    return attribute_value(node, "ID")


def _found(node: Node, port: str, group: int) -> Span:
    span = place_of(node)
    for match in _ATTRIBUTE.finditer(span.text):
        if match[1] == port:
            inner = group - 1  # the quotes
            return Span(span.source, span.start + match.start(group) + inner, span.start + match.end(group) - inner)
    return span

"""What a piece of syntax is lowered to, and the nodes that it is made of."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree.node import Node


class Lowered(Record):
    """A node, whether it can end SKIPPED, and whether it is `endless`: it runs until it fails or is stopped."""

    node: Node
    can_skip: bool = False
    endless: bool = False


def new_node(node_id: str, children: Sequence[Node], span: Span, **ports: str) -> Node:
    """A node with its ports."""
    return Node(node_id, tuple(children), tuple(ports.items()), span=span)


def new_round(body: Lowered) -> Node:
    """A skipped round counts as a round."""
    if not body.can_skip:
        return body.node
    span = body.node.span
    assert span is not None
    return new_node("Sequence", (body.node, new_node("AlwaysSuccess", (), span)), span)

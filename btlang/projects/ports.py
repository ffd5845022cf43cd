"""The ports of nodes by their models: unknown and missing ones, and values of another type."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.btcpp.spelling import AUTOREMAP, TRUE
from btlang.projects.places import attribute_name, attribute_value, place_of
from btlang.projects.port_values import wanted
from btlang.text.source import Span
from btlang.text.spelling import is_misspelling, nearest
from btlang.tree.catalogue import SUBTREE
from btlang.tree.model import NodeModel
from btlang.tree.node import Node


def port_problems(node: Node, model: NodeModel) -> Iterator[Diagnostic]:
    """BT232 for ports that the model doesn't have, BT233 for values of another type, BT234 for missing ports."""
    ports = {port.name: port for port in model.ports}
    given = dict(node.ports)
    unknown = [name for name in given if name not in ports and name[:1] != "_" and name != "ID"]
    missing = [port.name for port in model.ports if _must_be_given(port.direction, port.default, given.get(port.name))]
    for name in unknown:
        near = nearest(name.lower(), [port for port in ports if port not in given])
        fix = respelling(attribute_name(node, name), near)
        missing = [port for port in missing if fix is None or port != fix[1]]
        help = f"Similar: {', '.join(near)}" if near else f"It has {', '.join(ports) or 'none'}."
        yield diagnostic("BT232", attribute_name(node, name), (), fix, port=name, id=node.id, help=help)
    for name in missing:
        yield diagnostic("BT234", place_of(node), id=node.id, port=name)
    for name, text in node.ports:
        port = ports.get(name)
        if port is None or not text.strip() or "{" in text or port.direction == "output":
            continue
        if expected := wanted(text.strip(), port.type):
            yield diagnostic("BT233", attribute_value(node, name), text=text, port=name, id=node.id, wanted=expected)


def _must_be_given(direction: str, default: str | None, text: str | None) -> bool:
    return direction != "output" and default is None and text is None


def respelling(span: Span, near: list[str]) -> tuple[Span, str] | None:
    """The change of a misspelt name to the one name that is near; None where that isn't certain."""
    certain = len(near) == 1 and is_misspelling(span.text, near[0], ())
    return (span, near[0]) if certain else None


def subtree_problems(node: Node, model: NodeModel) -> Iterator[Diagnostic]:
    """BT132 for ports that the model of a tree requires, as BehaviorTree.CPP 4 does."""
    if node.port(AUTOREMAP) in TRUE:
        return
    for port in model.ports:
        if not port.default and port.name[:1] != "_" and not any(key == port.name for key, _ in node.ports):
            reason = f"the model of {model.id} requires the port {port.name}"
            yield diagnostic("BT132", place_of(node), id=SUBTREE, reason=reason)

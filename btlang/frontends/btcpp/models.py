"""TreeNodesModel: what a file declares about kinds of nodes, and what is known of those of Nav2."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from functools import cache

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.btcpp.fragments import Notes
from btlang.frontends.btcpp.scan import Document
from btlang.frontends.btcpp.spelling import KINDS, is_xml_name
from btlang.text.source import Span
from btlang.text.spelling import nearest
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import NodeModel, PortModel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.spelling import Pairs

_DIRECTIONS = {
    "input_port": "input",
    "output_port": "output",
    "inout_port": "inout",
    "bidirectional_port": "inout",
    "Parameter": "input",
}
MODEL_KINDS = (*KINDS, SUBTREE)
_NAV2 = os.path.join(os.path.dirname(__file__), "nav2.toml")
_OPTIONAL = "?"
_MARKS = {"<": "output", "=": "inout"}


class ModelReader:
    """Reads the models of one file. `warnings` report what is left out."""

    def __init__(self, document: Document, notes: Notes) -> None:
        self.warnings: list[Diagnostic] = []
        self._document = document
        self._notes = notes

    def read(self, index: int) -> Iterator[tuple[int, NodeModel]]:
        """The models in element `index`, a TreeNodesModel, each with its own element."""
        document = self._document
        for at in self._inner(index):
            tag = document.elements[at][0]
            node_id = document.attributes(at).get("ID", "")
            if tag not in MODEL_KINDS:
                self._odd(at, f"<{tag}> in <TreeNodesModel>", "has no effect", among(tag))
            elif not node_id.strip():
                self._odd(at, f"This <{tag}>", "describes no node", "Give it the ID of one, or remove it.")
            else:
                yield at, NodeModel(tag, node_id, tuple(self._ports(at)), self._description(at))

    def _ports(self, index: int) -> Iterator[PortModel]:
        for at in self._inner(index):
            direction = _DIRECTIONS.get(self._document.elements[at][0])
            if direction is None:
                continue
            attributes = self._document.attributes(at)
            name = attributes.get("name", attributes.get("label", ""))
            reason = why_no_port(name)
            if not name:
                self._odd(at, f"This <{self._document.elements[at][0]}>", "has no name", "Name the port, or remove it.")
            elif reason:
                self._odd(at, f"'{name}'", f"can't be a port: {reason}", "Rename the port, or remove it.")
            else:
                text = self._text(at) or attributes.get("description", "")
                yield PortModel(name, direction, attributes.get("type", ""), attributes.get("default"), text)

    def _description(self, index: int) -> str:
        for at in self._inner(index):
            tag = self._document.elements[at][0]
            if tag == "description":
                return self._text(at)
            for field in self._inner(at) if tag == "MetadataFields" else ():
                text = self._document.attributes(field).get("description")
                if text is not None:
                    return text
        return self._document.attributes(index).get("description", "")

    def _inner(self, index: int) -> Iterator[int]:
        at, end = index + 1, self._document.end(index)
        while at < end:
            yield at
            at = self._document.end(at)

    def _text(self, index: int) -> str:
        return " ".join(" ".join(note.text.split()) for note in self._notes.inside(index) if note.is_text)

    def _odd(self, index: int, what: str, problem: str, advice: str) -> None:
        self.warnings.append(odd(self._document.span(index), what, problem, advice))


def odd(span: Span, what: str, problem: str, advice: str, fix: tuple[Span, str] | None = None) -> Diagnostic:
    """That BehaviorTree.CPP takes no notice of a part of a file (BT230)."""
    return diagnostic("BT230", span, (), fix, what=what, problem=problem, advice=advice)


def among(tag: str, known: Iterable[str] = MODEL_KINDS) -> str:
    """What could be meant by a tag that is not known."""
    names = nearest(tag, known) or list(known)
    return f"It can contain {', '.join(f'<{name}>' for name in names)}."


def why_no_port(name: str) -> str:
    """Why a port cannot have a name, "" where it can."""
    if name in ("ID", "name"):
        return "this attribute describes the node itself"
    return "" if is_xml_name(name) else "an attribute cannot have this name"


def subtree_defaults(models: Mapping[str, NodeModel]) -> dict[str, Pairs]:
    """Of each tree that has a model, the ports with a default, and that.

    As in BehaviorTree.CPP an empty text is none; a name such as `_autoremap` describes the node, and is no port.
    """
    return {name: tuple((port.name, port.default) for port in model.ports if port.default and port.name[:1] != "_")
            for name, model in models.items()}  # fmt: skip


def nav2_models(ids: Iterable[str], left_out: str | None = None) -> dict[str, NodeModel]:
    """The models of those ids that Nav2 has nodes for; `left_out` is the default of ports that may be left out."""
    found = _nav2()
    return {
        node_id: NodeModel(found[node_id][0], node_id, tuple(_port(text, left_out) for text in found[node_id][1]))
        for node_id in ids
        if node_id in found
    }


@cache
def _nav2() -> dict[str, tuple[str, list[str]]]:
    """Kinds and ports of Nav2's nodes by id."""
    import tomllib

    with open(_NAV2, "rb") as file:
        kinds = tomllib.load(file)
    return {node_id: (kind, ports) for kind, nodes in kinds.items() for node_id, ports in nodes.items()}


def _port(text: str, left_out: str | None) -> PortModel:
    direction = _MARKS.get(text[0], "input")
    name, _, rest = text.lstrip("<=").partition(":")
    kind, has_default, default = rest.partition("=")
    usual = left_out if name.endswith(_OPTIONAL) else None
    return PortModel(name.rstrip(_OPTIONAL), direction, kind.strip(), default.strip() if has_default else usual)

"""The tree of a run as Groot2 wants it, and log files of BehaviorTree.CPP (FileLogger2)."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterable, Iterator

from btlang.backends.btcpp.markup import Markers
from btlang.diagnostics.errors import MissionError
from btlang.frontends.btcpp.spelling import MAIN_TREE, is_xml_name
from btlang.monitor.groot_protocol import CODES, MOST_NODES, transition
from btlang.run.events import Event, StatusesChanged
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Nodes


_MODELS = re.compile(r"<TreeNodesModel\b.*</TreeNodesModel>", re.DOTALL)
_UNWRITABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


class GrootTree:
    """The nodes of a run. The number of a node is its place in preorder, from 1 on.

    `label` gives the words of a node, `xml` the mission as XML of BehaviorTree.CPP, for what it says of its nodes.
    """

    def __init__(self, nodes: Nodes, parent: Callable[[int], int], label: Callable[[Node], str], xml: str) -> None:
        self.size = min(nodes.size, MOST_NODES)
        self._nodes = [nodes.node(index) for index in range(self.size)]
        self._label, self._models = label, _MODELS.search(xml)
        self._children: list[list[int]] = [[] for _ in range(self.size)]
        for index in range(1, self.size):
            self._children[parent(index)].append(index)
        self.blackboards = dict(self._trees())
        """The node at the root of each tree, by the name of its blackboard: the path of its use, or the main ID."""

    def _trees(self) -> Iterator[tuple[str, int]]:
        """Yield path and root of each use of a subtree; the main one comes first."""
        yield MAIN_TREE, 0
        paths = {0: ""}
        for index, node in enumerate(self._nodes):
            for child in self._children[index]:
                paths[child] = paths[index]
            if node.id == SUBTREE and self._children[index]:
                path = f"{paths[index]}/{_name(node)}::{index + 1}".lstrip("/")
                [root] = self._children[index]
                paths[root] = path
                yield path, root

    def to_xml(self) -> str:
        """Write XML with paths (`_fullpath`) and numbers (`_uid`)."""
        lines = ['<?xml version="1.0" encoding="UTF-8"?>', '<root BTCPP_format="4">']
        for path, root in self.blackboards.items():
            ID = MAIN_TREE if root == 0 else _name(self._nodes[root - 1])
            lines.append(f"<BehaviorTree{_attributes((('ID', ID), ('_fullpath', '' if root == 0 else path)))}>")
            self._add(root, lines)
            lines.append("</BehaviorTree>")
        if self._models is not None:
            lines.append(self._models[0])
        return "\n".join([*lines, "</root>", ""])

    def _add(self, root: int, lines: list[str]) -> None:
        stack: list[int | str] = [root]
        while stack:
            index = stack.pop()
            if isinstance(index, str):
                lines.append(index)
                continue
            node, children = self._nodes[index], self._children[index]
            tag, attributes = self._tag(index, node)
            if children and node.id != SUBTREE:
                lines.append(f"<{tag}{attributes}>")
                stack += [f"</{tag}>", *reversed(children)]
            else:
                lines.append(f"<{tag}{attributes}/>")

    def _tag(self, index: int, node: Node) -> tuple[str, str]:
        pairs = [(port, text) for port, text in node.ports if is_xml_name(port) and port not in ("name", "_uid")]
        tag = node.id
        if node.id == SUBTREE:
            path = next((path for path, root in self.blackboards.items() if root == index + 1), "")
            pairs = [("ID", _name(node)), *((port, text) for port, text in pairs if port != "ID"), ("_fullpath", path)]
        elif not is_xml_name(tag):
            pairs, tag = [("ID", tag), *pairs], "Action"
        return tag, _attributes((*pairs, ("name", self._label(node)), ("_uid", str(index + 1))))


def _name(node: Node) -> str:
    return node.port("ID")


def _attributes(pairs: tuple[tuple[str, str], ...]) -> str:
    """Write attributes; Groot gets a `?` for what XML can't hold."""
    return Markers().attributes(tuple((key, _UNWRITABLE.sub("?", text)) for key, text in pairs))


def models_of(to_xml: Callable[[], str]) -> str:
    """Return the XML of a mission, "" where it has none: Groot then draws nodes that it doesn't know without their
    ports.
    """
    try:
        return to_xml()
    except MissionError:
        return ""


MAGIC = b"BTCPP4-FileLogger2"
_FORMAT = 1


def to_btlog(tree: GrootTree, events: Iterable[Event]) -> bytes:
    """Return the file: the tree, the wall time at which the run began, and each change with its time since then."""
    xml = tree.to_xml().encode("utf-8", "replace")
    began: float | None = None
    changes: list[bytes] = []
    for event in events:
        if began is None:
            began = event.wall - event.t
        if isinstance(event, StatusesChanged):
            at = max(0, int(event.t * 1e6))  # mission time: a pause is no part of it
            changes += [
                transition(at, index + 1, CODES[status]) for index, status, _, _ in event.changes if index < tree.size
            ]
    head = MAGIC + bytes([_FORMAT]) + struct.pack("<i", len(xml))
    return b"".join((head, xml, struct.pack("<q", int((began or 0.0) * 1e6)), *changes))

"""Protocol 2 of Groot2, as BehaviorTree.CPP 4 speaks it (groot2_protocol.h): messages, trees and log files."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterable, Iterator

from btlang.backends.btcpp.markup import Markers
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.frontends.btcpp.spelling import MAIN_TREE, is_xml_name
from btlang.run.events import Event, StatusesChanged
from btlang.support.record import Record
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Nodes


PROTOCOL = 2
FULL_TREE, STATUS, BLACKBOARDS = b"T", b"S", b"B"
HOOK_INSERT, HOOK_REMOVE, HOOKS_DUMP = b"I", b"R", b"D"
REMOVE_ALL_HOOKS, DISABLE_ALL_HOOKS = b"A", b"X"
BREAKPOINT_REACHED, BREAKPOINT_UNLOCK = b"N", b"U"
TOGGLE_RECORDING, TRANSITIONS = b"r", b"t"

MOST_NODES = 65_535
"""The most nodes: they have numbers of 16 bits, from 1 on."""
MOST_TRANSITIONS = 1_000
"""The number of latest transitions that are kept for a client that records."""
RESET = 10
"""A number that is added to the last status of a node that was reset."""
CODES = {IDLE: 0, RUNNING: 1, SUCCESS: 2, FAILURE: 3, SKIPPED: 4}
NAMES = {"IDLE": IDLE, "RUNNING": RUNNING, "SUCCESS": SUCCESS, "FAILURE": FAILURE, "SKIPPED": SKIPPED}
_HEADER = struct.Struct("<BcI")
_STATUS = struct.Struct("<HB")
_TRANSITION = struct.Struct("<IHHB")  # the time has 6 bytes


class GrootRequest(Record):
    """The head of a request: a letter, and a number that the reply repeats."""

    letter: bytes
    number: int


def read_request(head: bytes) -> GrootRequest:
    """Raise ValueError for what is no head of a request."""
    if len(head) != _HEADER.size:
        raise ValueError("wrong request header")
    protocol, letter, number = _HEADER.unpack(head)
    if protocol != PROTOCOL:
        raise ValueError(f"protocol {protocol} instead of {PROTOCOL}")
    return GrootRequest(letter, number)


def head(letter: bytes, number: int, tree_id: bytes = b"") -> bytes:
    """Return the head of a request, or with the id of the tree (16 bytes) that of a reply."""
    return _HEADER.pack(PROTOCOL, letter, number) + tree_id


def statuses(codes: bytes) -> bytes:
    """Return the numbers of all nodes with their codes, in order."""
    return b"".join(map(_STATUS.pack, range(1, len(codes) + 1), codes))


def transition(microseconds: int, uid: int, code: int) -> bytes:
    """Return a change of a status, at a time since the recording began."""
    return _TRANSITION.pack(microseconds & 0xFFFFFFFF, microseconds >> 32 & 0xFFFF, uid, code)


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

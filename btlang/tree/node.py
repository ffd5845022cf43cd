"""Trees, which every front end makes and every back end reads, with BehaviorTree.CPP node names, ports and semantics.

A tree may have models of its leaves, as TreeNodesModel of BehaviorTree.CPP holds them.
"""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.support.record import Record
from btlang.text.source import PythonSource, Span


class PortModel(Record):
    """A declared port: `direction` is "input", "output" or "inout", `type` as in C++, "" if it isn't declared."""

    name: str
    direction: str = "input"
    type: str = ""
    default: str | None = None
    text: str = ""


class NodeModel(Record):
    """A kind of node: "Action", "Condition", "Decorator", "Control" or "SubTree"; `text` is its description."""

    kind: str
    id: str
    ports: tuple[PortModel, ...] = ()
    text: str = ""


class Node(Record, uncompared=("span",)):
    """A node of a tree.

    `id` is the registered type (`Sequence`, `GoTo`); `ports` are (name, text) pairs, text as XML would hold it,
    a text `{key}` refers to the blackboard; `name` is an instance name, "" where none was given;
    `span` is the sentence that it came from.
    """

    id: str
    children: tuple[Node, ...] = ()
    ports: tuple[tuple[str, str], ...] = ()
    name: str = ""
    span: Span | None = None

    @property
    def source_text(self) -> str:
        """The text that it came from; its id if that isn't known, or is Python."""
        return self.id if self.span is None or isinstance(self.span.source, PythonSource) else self.span.text

    def port(self, name: str, default: str = "") -> str:
        """Return the text of a port, or the default if it isn't set."""
        for key, text in self.ports:
            if key == name:
                return text
        return default


class Tree(Record, uncompared=("models", "origin", "warnings")):
    """A main tree and the named subtrees that its SubTree nodes (port `ID`) refer to, in the order defined.

    `name` is that of the main tree, "" for the usual one (`MainTree` in XML); no two trees have the same. `models` are
    what a front end has read about kinds of nodes. `origin` is what a front end knows beside the tree, for its own
    back end: such as the comments of an XML file, and how its tags were written; of a mission it is its Source.
    `warnings` are those of reading it.
    """

    root: Node
    subtrees: tuple[tuple[str, Node], ...] = ()
    name: str = ""
    models: tuple[NodeModel, ...] = ()
    origin: object = None
    warnings: tuple[Diagnostic, ...] = ()

    def walk(self) -> Iterator[Node]:
        """Yield every node of the main tree, then of each subtree, parents before children; SubTree nodes aren't
        entered.
        """
        for root in (self.root, *(node for _, node in self.subtrees)):
            stack = [root]
            while stack:
                node = stack.pop()
                yield node
                stack.extend(reversed(node.children))

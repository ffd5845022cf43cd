"""What is known of a kind of node beside its uses: TreeNodesModel of BehaviorTree.CPP."""

from __future__ import annotations

from btlang.support.record import Record


class PortModel(Record):
    """A port: `direction` is "input", "output" or "inout", `type` as in C++, "" if it isn't declared."""

    name: str
    direction: str = "input"
    type: str = ""
    default: str | None = None
    text: str = ""


class NodeModel(Record):
    """`kind` is "Action", "Condition", "Decorator", "Control" or "SubTree"; `text` is its description."""

    kind: str
    id: str
    ports: tuple[PortModel, ...] = ()
    text: str = ""

"""The statuses that the nodes of a tree ended a run with, and the values that they had then."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.engine.status import IDLE, RUNNING
from btlang.run.bus import INLINE
from btlang.run.events import StatusesChanged
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Event

_LONGEST_PATH = 1000  # characters; no picture shows nodes so deep


class LastStatuses:
    """A sink. `by_path` has the last status of each node that was reached, the latest change last.

    IDLE stands for a node that was halted while it ran; a reset after it completed is no status. `nodes` has those
    whose ports name values, with these values in them: the last ones, or, where they were not reached, their arguments.
    """

    policy = INLINE

    def __init__(self) -> None:
        self.by_path: dict[str, int] = {}
        self.nodes: dict[str, Node] = {}

    def __call__(self, event: Event) -> None:
        if not isinstance(event, StatusesChanged):
            return
        if not self.by_path:
            nodes = event.nodes
            filled = ((index, nodes.filled(index)) for index in range(nodes.size))
            self.nodes = {nodes.path(index): node for index, node in filled if node is not nodes.node(index)}
        for change in event:
            before = self.by_path.get(change.path)
            if len(change.path) <= _LONGEST_PATH and (change.status != IDLE or before == RUNNING):
                self.by_path.pop(change.path, None)
                self.by_path[change.path] = change.status
                if change.index in event.valued:
                    self.nodes[change.path] = event.valued[change.index]


def by_definition(statuses: Mapping[str, int], tree: Tree) -> dict[tuple[str, str], int]:
    """Return the same by name of the subtree ("" is the main tree) and path in it: the latest of all its uses."""
    found: dict[tuple[str, str], int] = {}
    for path, status in statuses.items():
        for key in _keys(path, tree):
            found[key] = status
    return found


def _keys(path: str, tree: Tree) -> Iterator[tuple[str, str]]:
    """Yield where the node is drawn; nothing for a path that the tree does not have."""
    subtrees = dict(tree.subtrees)
    name, node, steps = "", tree.root, ""
    for step in path.strip("/").split("/") if path != "/" else ():
        if node.id == SUBTREE:
            name, steps = node.port("ID"), ""
            if name not in subtrees:
                return
            node = subtrees[name]
        elif int(step) < len(node.children):
            node, steps = node.children[int(step)], f"{steps}/{step}"
        else:
            return
    yield name, steps or "/"

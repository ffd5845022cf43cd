"""The statuses that the nodes of a tree ended a run with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.engine.status import IDLE, RUNNING
from btlang.run.bus import INLINE
from btlang.run.events import StatusesChanged
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Event

_LONGEST_PATH = 1000  # characters; no picture shows nodes so deep


class LastStatuses:
    """A sink. `by_path` has the last status of each node that was reached, the latest change last.

    IDLE stands for a node that was halted while it ran; a reset after it completed is no status.
    """

    policy = INLINE

    def __init__(self) -> None:
        self.by_path: dict[str, int] = {}

    def __call__(self, event: Event) -> None:
        for change in event if isinstance(event, StatusesChanged) else ():
            before = self.by_path.get(change.path)
            if len(change.path) <= _LONGEST_PATH and (change.status != IDLE or before == RUNNING):
                self.by_path.pop(change.path, None)
                self.by_path[change.path] = change.status


def by_definition(statuses: Mapping[str, int], tree: Tree) -> dict[tuple[str, str], int]:
    """The same by name of the subtree ("" is the main tree) and path in it: the latest of all its uses."""
    found: dict[tuple[str, str], int] = {}
    for path, status in statuses.items():
        for key in _keys(path, tree):
            found[key] = status
    return found


def _keys(path: str, tree: Tree) -> Iterator[tuple[str, str]]:
    """Where the node is drawn; nothing for a path that the tree does not have."""
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

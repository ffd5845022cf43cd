"""A tree as boxes with text, before it is known where they go."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping

from btlang.engine.status import FAILURE
from btlang.passes.scripts import is_prepared
from btlang.pictures.letters import shown
from btlang.pictures.statuses import LastStatuses, by_definition
from btlang.printer.phrase import MARKUP, seconds
from btlang.support.record import Record
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree

IN_PLACE = 500  # nodes; a tree that is larger with its subtrees filled in is drawn apart
MOST = 2000  # nodes in a picture; what is beyond becomes "... and 17 more"
DEEPEST = 60

_TIMES = "\N{MULTIPLICATION SIGN}"


class Box(Record):
    """A node. `shape` is control, decorator, action, condition, frame (a subtree in place), subtree (a name) or more.

    `parent` is the index of the box that it hangs on, -1 for none; `role` says what it is to its parent.
    `status` is None where the node was never reached or there was no run.
    """

    shape: str
    text: str
    symbol: str = ""
    parent: int = -1
    role: str = ""
    status: int | None = None


class Sheet(Record):
    """A tree that is drawn in one piece; parents come before their children, children in order. "" is the main tree."""

    name: str
    boxes: tuple[Box, ...]


def title_of(tree: Tree) -> str:
    """What heads a picture: the name of the mission's file, else the name of the tree or the first line of the text."""
    span = next((node.span for node in tree.walk() if node.span is not None), None)
    given = tree.name or "mission"
    if span is None:
        return shown(given)
    if span.source.name != "-" and not span.source.name.startswith("<"):
        return shown(os.path.basename(span.source.name))
    first = span.text.partition("\n")[0]
    return shown(given if first.startswith(MARKUP) or not first.strip() else first)


class Maker:
    """Makes the sheets of a tree. `label` and `is_action` are those of btlang.api.Mission.

    `run` has the statuses and values of a run; in its picture what only computes the values of a command is left out.
    """

    def __init__(
        self,
        tree: Tree,
        label: Callable[[Node], str],
        is_action: Callable[[Node], bool],
        run: LastStatuses | None = None,
    ) -> None:
        self._tree = tree
        self._subtrees = dict(tree.subtrees)
        self._label = label
        self._is_action = is_action
        self._has_run = run is not None
        self._statuses = run.by_path if run is not None else {}
        self._nodes = run.nodes if run is not None else {}

    def sheets(self, apart: bool = False) -> list[Sheet]:
        """One sheet, with the subtrees in place; or, if asked for or needed, the main tree and one of each subtree."""
        if not apart or not self._subtrees:
            most = IN_PLACE if self._subtrees else MOST
            sheet = self._sheet("", self._tree.root, self._statuses, most, whole=bool(self._subtrees))
            if sheet is not None:
                return [sheet]
        found = by_definition(self._statuses, self._tree)
        sheets: list[Sheet] = []
        left = MOST
        for name, root in (("", self._tree.root), *self._tree.subtrees):
            statuses = {path: status for (owner, path), status in found.items() if owner == name}
            sheet = self._sheet(name, root, statuses, max(left, 1), apart=True)
            assert sheet is not None
            sheets.append(sheet)
            left -= len(sheet.boxes)
        return sheets

    def _sheet(
        self, name: str, root: Node, statuses: Mapping[str, int], most: int, *, apart: bool = False, whole: bool = False
    ) -> Sheet | None:
        """None where it must be `whole` and is larger than `most`."""
        boxes: list[Box] = []
        nodes = {} if name else self._nodes  # a definition is drawn for all its uses
        cut: dict[int, int] = {}  # nodes left out, by the box that they would hang on
        stack = [(root, -1, "/", "", 0)]
        while stack:
            node, parent, path, role, depth = stack.pop()
            if self._has_run:
                node, path = _command(node, path, statuses)
            if len(boxes) >= most or depth > DEEPEST:
                if whole and len(boxes) >= most:
                    return None
                cut[parent] = cut.get(parent, 0) + _size(node)
                continue
            index = len(boxes)
            children = node.children
            if node.id == SUBTREE and not apart and node.port("ID") in self._subtrees:
                children = (self._subtrees[node.port("ID")],)
            boxes.append(self._box(nodes.get(path, node), bool(children), parent, role, statuses.get(path)))
            kind = CATALOGUE.get(node.id)
            roles = kind.roles if kind is not None else ()
            for i in range(len(children) - 1, -1, -1):
                below = f"{path.rstrip('/')}/{i}"
                stack.append((children[i], index, below, roles[i] if i < len(roles) else "", depth + 1))
        boxes += [Box("more", f"… and {count} more", parent=parent) for parent, count in cut.items()]
        return Sheet(name, tuple(boxes))

    def _box(self, node: Node, has_children: bool, parent: int, role: str, status: int | None) -> Box:
        if node.id == SUBTREE:
            shape = "frame" if has_children else "subtree"
            return Box(shape, shown(self._label(node)), "", parent, role, status)
        kind = CATALOGUE.get(node.id)
        if has_children:
            shape = "decorator" if kind is not None and kind.most == 1 else "control"
            return Box(shape, shown(_named(node)), kind.symbol if kind is not None else "", parent, role, status)
        shape = "action" if kind is not None or self._is_action(node) else "condition"
        skipped = " (skipped)" if node.port("_skipIf") == "true" else ""
        return Box(shape, shown(self._label(node.replace(ports=_plain(node))) + skipped), "", parent, role, status)


def _command(node: Node, path: str, statuses: Mapping[str, int]) -> tuple[Node, str]:
    """What is drawn for a node, with its path: the command that scripts prepare, unless one of these failed."""
    last, above = len(node.children) - 1, path.rstrip("/")
    if is_prepared(node) and all(statuses.get(f"{above}/{i}") != FAILURE for i in range(last)):
        return node.children[last], f"{above}/{last}"
    return node, path


def _plain(node: Node) -> tuple[tuple[str, str], ...]:
    return tuple((key, text) for key, text in node.ports if key != "_skipIf")


def _named(node: Node) -> str:
    """The id with its ports in short: `Repeat x3`, `Timeout 5 s`."""
    words = [node.name, node.id]
    kind = CATALOGUE.get(node.id)
    for key, text in node.ports:
        port = kind.ports.get(key) if kind is not None else None
        unit = port.unit if port is not None else ""
        if unit == "rounds":
            words.append(_TIMES + ("∞" if text == "-1" else text))
        elif unit == "ms":
            words.append(seconds(text))
        else:
            words.append(f"{key}={text}")
    return " ".join(word for word in words if word)


def _size(root: Node) -> int:
    count, stack = 0, [root]
    while stack:
        node = stack.pop()
        count += 1
        stack.extend(node.children)
    return count

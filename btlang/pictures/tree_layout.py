"""A tree as boxes with text, and where these go: the root at the left, children from top to bottom."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from math import ceil, sqrt

from btlang.engine.status import FAILURE
from btlang.passes.scripts import is_prepared
from btlang.pictures.letters import make_printable, width, wrap_text
from btlang.pictures.run_record import LastStatuses, by_definition
from btlang.pictures.surface import SMALL, TEXT
from btlang.printer.phrase import MARKUP, seconds
from btlang.support.record import Record
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree

IN_PLACE = 500  # nodes; a tree that is larger with its subtrees filled in is drawn apart
MOST = 2000  # nodes in a picture; what is beyond becomes "... and 17 more"
DEEPEST = 60

_TIMES = "\N{MULTIPLICATION SIGN}"


class TreeBox(Record):
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
    boxes: tuple[TreeBox, ...]


def title_of(tree: Tree) -> str:
    """Return what heads a picture: the name of the mission's file, else the name of the tree or the first line of the
    text.
    """
    span = next((node.span for node in tree.walk() if node.span is not None), None)
    given = tree.name or "mission"
    if span is None:
        return make_printable(given)
    if span.source.name != "-" and not span.source.name.startswith("<"):
        return make_printable(os.path.basename(span.source.name))
    first = span.text.partition("\n")[0]
    return make_printable(given if first.startswith(MARKUP) or not first.strip() else first)


class Maker:
    """A maker of the sheets of a tree. `label` and `is_action` are those of btlang.api.Mission.

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
        """Make one sheet, with the subtrees in place; or, if asked for or needed, the main tree and one of each
        subtree.
        """
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
        """Make a sheet; None where it must be `whole` and is larger than `most`."""
        boxes: list[TreeBox] = []
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
        boxes += [TreeBox("more", f"… and {count} more", parent=parent) for parent, count in cut.items()]
        return Sheet(name, tuple(boxes))

    def _box(self, node: Node, has_children: bool, parent: int, role: str, status: int | None) -> TreeBox:
        if node.id == SUBTREE:
            shape = "frame" if has_children else "subtree"
            return TreeBox(shape, make_printable(self._label(node)), "", parent, role, status)
        kind = CATALOGUE.get(node.id)
        if has_children:
            shape = "decorator" if kind is not None and kind.most == 1 else "control"
            return TreeBox(
                shape, make_printable(_name(node)), kind.symbol if kind is not None else "", parent, role, status
            )
        shape = "action" if kind is not None or self._is_action(node) else "condition"
        skipped = " (skipped)" if node.port("_skipIf") == "true" else ""
        return TreeBox(
            shape, make_printable(self._label(node.replace(ports=_plain(node))) + skipped), "", parent, role, status
        )


def _command(node: Node, path: str, statuses: Mapping[str, int]) -> tuple[Node, str]:
    """Return what is drawn for a node, with its path: the command that scripts prepare, unless one of these failed."""
    last, above = len(node.children) - 1, path.rstrip("/")
    if is_prepared(node) and all(statuses.get(f"{above}/{i}") != FAILURE for i in range(last)):
        return node.children[last], f"{above}/{last}"
    return node, path


def _plain(node: Node) -> tuple[tuple[str, str], ...]:
    return tuple((key, text) for key, text in node.ports if key != "_skipIf")


def _name(node: Node) -> str:
    """Return the id with its ports in short: `Repeat x3`, `Timeout 5 s`."""
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


LINE_HEIGHT = 12.0
SIGN = 13.0  # room for the sign of a status
SYMBOL = 14.0
FRAME_TITLE, FRAME_SIDE = 19.0, 10.0
STUB = 10.0  # of a line, before it bends
HEAD = 16.0  # room above columns, for the line from one to the next
_WIDEST, _WIDEST_LEAF = 150.0, 175.0  # of a text; leaves are sentences
_LINES = 3
_TOP = 4.5
_GAP, _BIG_GAP = 5.0, 9.0  # between leaves, and between branches
_JOG = 14.0  # a bend by less looks like a mistake
_REACH = 22.0  # from a box to its children
_ROLE = 5.0  # more than a role takes
_COLUMN_GAP = 30.0
_HIGH = 1100.0  # points; what is higher is put in columns
_FLAT = 1.25  # how much wider than high a picture with columns may be


def side(box: TreeBox) -> float:
    """Return the room between the left edge of a box and its text."""
    return 11.0 if box.shape in ("decorator", "condition", "subtree") else 7.0


class Block:
    """A box and its descendants. `anchor` is how far below the top of the block its link comes in.

    `places` are the upper left corners of the children's blocks, from the corner of this one; `column` is the x of the
    first column. `width` and `height` are those of the box itself.
    """

    def __init__(self, box: TreeBox, signs: bool) -> None:
        self.box = box
        self.is_frame = box.shape == "frame"
        bold = box.shape in ("control", "decorator", "frame", "subtree")
        widest = _WIDEST_LEAF if box.shape in ("action", "condition") else _WIDEST
        lines = wrap_text(box.text, widest, 1 if self.is_frame else _LINES, TEXT, bold)
        self.lines = tuple(lines)
        self.width = max(width(line, TEXT, bold) for line in lines) + 2 * side(box)
        self.width += (SIGN if signs and box.shape != "more" else 0) + (SYMBOL if box.symbol else 0)
        self.height = len(lines) * LINE_HEIGHT + 2 * _TOP
        self.places: list[tuple[float, float]] = []
        self.column = self.whole_width = self.whole_height = self.anchor = 0.0

    def enclose(self, blocks: Sequence[Block], *, in_columns: bool = False) -> None:
        """Take in the blocks of the children, whose sizes are known; `in_columns` allows more than one column."""
        if self.is_frame:
            self._surround(blocks[0])
            return
        roles = max((width(block.box.role, SMALL) for block in blocks), default=0.0)
        self.column = self.width + max(_REACH, STUB + _ROLE + roles)
        columns = _columns(blocks) if in_columns else [list(blocks)]
        if len(columns) > 1:
            self._take(columns, HEAD)
            self.anchor = self.places[0][1] + blocks[0].anchor
        else:
            self._take(columns, 0.0)
            self.anchor = self._middle(blocks) if blocks else self.height / 2
        down = max(0.0, self.height / 2 - self.anchor)
        self.places = [(x, y + down) for x, y in self.places]
        self.anchor += down
        self.whole_height = max(self.whole_height + down, self.anchor + self.height / 2)

    def _surround(self, inner: Block) -> None:
        self.places = [(FRAME_SIDE, FRAME_TITLE)]
        self.width = self.whole_width = max(inner.whole_width + 2 * FRAME_SIDE, self.width)
        self.height = self.whole_height = FRAME_TITLE + inner.whole_height + FRAME_SIDE
        self.anchor = FRAME_TITLE + inner.anchor

    def _take(self, columns: list[list[Block]], top: float) -> None:
        self.whole_width = self.width
        left = self.column
        for column in columns:
            y = top
            for block, gap in zip(column, _gaps(column), strict=True):
                self.places.append((left, y + gap))
                y += gap + block.whole_height
                self.whole_width = max(self.whole_width, left + block.whole_width)
            self.whole_height = max(self.whole_height, y)
            left = self.whole_width + _COLUMN_GAP

    def _middle(self, blocks: Sequence[Block]) -> float:
        """Return the place half-way between the first child and the last, or straight at one that is near that."""
        anchors = [y + block.anchor for (_, y), block in zip(self.places, blocks, strict=True)]
        middle = (anchors[0] + anchors[-1]) / 2
        nearest = min(anchors, key=lambda anchor: abs(anchor - middle))
        return nearest if abs(nearest - middle) < _JOG else middle


def _gaps(blocks: Sequence[Block]) -> list[float]:
    """Return the room above each block."""
    gaps = [_BIG_GAP if one.places or two.places else _GAP for one, two in pairwise(blocks)]
    return [0.0, *gaps] if blocks else []


def _columns(blocks: Sequence[Block]) -> list[list[Block]]:
    """Return as many columns as make the whole about as wide as high."""
    heights = [block.whole_height + gap for block, gap in zip(blocks, _gaps(blocks), strict=True)]
    total = sum(heights)
    if total <= _HIGH:
        return [list(blocks)]
    width = max(block.whole_width for block in blocks) + _COLUMN_GAP
    number = max(1, ceil(sqrt(total / width * _FLAT) - 0.5))
    high = max(total / number, 0.6 * _HIGH)
    columns: list[list[Block]] = [[]]
    filled = 0.0
    for block, height in zip(blocks, heights, strict=True):
        if columns[-1] and filled + height / 2 > high and block.box.shape != "more":
            columns.append([])
            filled = 0.0
        columns[-1].append(block)
        filled += height
    return columns


class Spot(Record):
    """A box on the sheet: its upper left corner, its size, and its lines of text. A frame holds the boxes below it."""

    box: TreeBox
    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]


class BoxLink(Record):
    """The line from a parent's right side to a child's left; `role` is written at its end."""

    points: tuple[tuple[float, float], ...]
    role: str


class TreeLayout(Record):
    """The layout of a tree. Spots are in the order of the boxes, so that a frame comes before what it holds."""

    spots: tuple[Spot, ...]
    links: tuple[BoxLink, ...]
    width: float
    height: float


def lay_out(boxes: Sequence[TreeBox], signs: bool = False) -> TreeLayout:
    """Place the boxes; with `signs`, each has room for one. No two overlap, but a frame and what is in it.

    Where many branches make the tree very high, they stand in columns, to be read one column after the other.
    """
    children: list[list[int]] = [[] for _ in boxes]
    for index, box in enumerate(boxes):
        if box.parent >= 0:
            children[box.parent].append(index)
    trunk = 0
    while len(children[trunk]) == 1:
        trunk = children[trunk][0]
    blocks = [Block(box, signs) for box in boxes]
    for index in range(len(boxes) - 1, -1, -1):  # children come after their parents
        blocks[index].enclose([blocks[child] for child in children[index]], in_columns=index == trunk)
    spots: list[Spot] = []
    links: list[BoxLink] = []
    at = [(0.0, 0.0)] * len(boxes)
    for index, block in enumerate(blocks):
        left, top = at[index]
        y = top if block.is_frame else top + block.anchor - block.height / 2
        spots.append(Spot(block.box, left, y, block.width, block.height, block.lines))
        for child, (dx, dy) in zip(children[index], block.places, strict=True):
            at[child] = (left + dx, top + dy)
            links.append(_link(block, (left, top), (dx, dy + blocks[child].anchor), blocks[child].box.role))
    return TreeLayout(tuple(spots), tuple(links), blocks[0].whole_width, blocks[0].whole_height)


def _link(block: Block, corner: tuple[float, float], to: tuple[float, float], role: str) -> BoxLink:
    """Make a link; `to` is where it ends, from the corner of the block."""
    dx, dy = to
    right = 0.0 if block.is_frame else block.width
    points = [(right, block.anchor)]
    if not block.is_frame:
        points.append((right + STUB, block.anchor))
        if dx > block.column:  # along the top to a later column
            points += [(right + STUB, HEAD / 2), (dx - STUB, HEAD / 2), (dx - STUB, dy)]
        else:
            points.append((right + STUB, dy))
    points.append((dx, dy))
    return BoxLink(tuple((corner[0] + x, corner[1] + y) for x, y in points), role)

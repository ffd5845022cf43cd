"""The size of a box with all that hangs on it, from the leaves up."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, sqrt

from btlang.pictures.letters import width, wrapped
from btlang.pictures.style import SMALL, TEXT
from btlang.pictures.tree_boxes import Box

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


def side(box: Box) -> float:
    """Room between the left edge of a box and its text."""
    return 11.0 if box.shape in ("decorator", "condition", "subtree") else 7.0


class Block:
    """A box and its descendants. `anchor` is how far below the top of the block its link comes in.

    `places` are the upper left corners of the children's blocks, from the corner of this one; `column` is the x of the
    first column. `width` and `height` are those of the box itself.
    """

    def __init__(self, box: Box, signs: bool) -> None:
        self.box = box
        self.is_frame = box.shape == "frame"
        bold = box.shape in ("control", "decorator", "frame", "subtree")
        widest = _WIDEST_LEAF if box.shape in ("action", "condition") else _WIDEST
        lines = wrapped(box.text, widest, 1 if self.is_frame else _LINES, TEXT, bold)
        self.lines = tuple(lines)
        self.width = max(width(line, TEXT, bold) for line in lines) + 2 * side(box)
        self.width += (SIGN if signs and box.shape != "more" else 0) + (SYMBOL if box.symbol else 0)
        self.height = len(lines) * LINE_HEIGHT + 2 * _TOP
        self.places: list[tuple[float, float]] = []
        self.column = self.whole_width = self.whole_height = self.anchor = 0.0

    def enclose(self, blocks: Sequence[Block], *, in_columns: bool = False) -> None:
        """Takes in the blocks of the children, whose sizes are known; `in_columns` allows more than one column."""
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
        """Half-way between the first child and the last, or straight at one that is near that."""
        anchors = [y + block.anchor for (_, y), block in zip(self.places, blocks, strict=True)]
        middle = (anchors[0] + anchors[-1]) / 2
        nearest = min(anchors, key=lambda anchor: abs(anchor - middle))
        return nearest if abs(nearest - middle) < _JOG else middle


def _gaps(blocks: Sequence[Block]) -> list[float]:
    """The room above each block."""
    gaps = [_BIG_GAP if one.places or two.places else _GAP for one, two in pairwise(blocks)]
    return [0.0, *gaps] if blocks else []


def _columns(blocks: Sequence[Block]) -> list[list[Block]]:
    """As many columns as make the whole about as wide as high."""
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

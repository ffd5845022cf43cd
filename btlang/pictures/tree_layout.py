"""Where the boxes of a tree go: the root at the left, children in order from top to bottom, a row for each leaf."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.pictures.tree_block import HEAD, STUB, Block
from btlang.pictures.tree_boxes import Box
from btlang.support.record import Record


class Spot(Record):
    """A box on the sheet: its upper left corner, its size, and its lines of text. A frame holds the boxes below it."""

    box: Box
    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]


class Link(Record):
    """The line from a parent's right side to a child's left; `role` is written at its end."""

    points: tuple[tuple[float, float], ...]
    role: str


class Layout(Record):
    """Spots are in the order of the boxes, so that a frame comes before what it holds."""

    spots: tuple[Spot, ...]
    links: tuple[Link, ...]
    width: float
    height: float


def laid_out(boxes: Sequence[Box], signs: bool = False) -> Layout:
    """Places the boxes; with `signs`, each has room for one. No two overlap, but a frame and what is in it.

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
    links: list[Link] = []
    at = [(0.0, 0.0)] * len(boxes)
    for index, block in enumerate(blocks):
        left, top = at[index]
        y = top if block.is_frame else top + block.anchor - block.height / 2
        spots.append(Spot(block.box, left, y, block.width, block.height, block.lines))
        for child, (dx, dy) in zip(children[index], block.places, strict=True):
            at[child] = (left + dx, top + dy)
            links.append(_link(block, (left, top), (dx, dy + blocks[child].anchor), blocks[child].box.role))
    return Layout(tuple(spots), tuple(links), blocks[0].whole_width, blocks[0].whole_height)


def _link(block: Block, corner: tuple[float, float], to: tuple[float, float], role: str) -> Link:
    """`to` is where it ends, from the corner of the block."""
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
    return Link(tuple((corner[0] + x, corner[1] + y) for x, y in points), role)

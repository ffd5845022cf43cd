"""The picture of a tree, with the statuses of a run in colour; also as a target of `btc compile`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import sqrt

from btlang.diagnostics.files import write_file
from btlang.pictures import letters
from btlang.pictures.drawing import open_drawing
from btlang.pictures.files import STILL, picture_ending
from btlang.pictures.letters import make_printable
from btlang.pictures.surface import HEADING, INK, LINE, LOOKS, NEVER, PAPER, SMALL, SOFT, TEXT, TITLE, Look
from btlang.pictures.tree_layout import (
    FRAME_TITLE,
    LINE_HEIGHT,
    SIGN,
    SYMBOL,
    BoxLink,
    Maker,
    Sheet,
    Spot,
    TreeLayout,
    lay_out,
    side,
    title_of,
)
from btlang.printer.phrase import phrase_of
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.run_record import LastStatuses
    from btlang.pictures.surface import Surface


_MARGIN = 16.0
_LEGEND = 26.0
_LEAST_WIDE = 260.0  # where the title needs it
_TITLE = 24.0  # above a subtree that is drawn apart
_WIDTH = 900.0  # subtrees that are drawn apart stand side by side up to it
_FILLS = {
    "control": "#dfe8f3",
    "decorator": "#e8e1f2",
    "action": PAPER,
    "condition": "#f4f1e4",
    "subtree": "#edf2ee",
    "more": PAPER,
}
_EDGES = {
    "control": "#4d6f96",
    "decorator": "#7a64a0",
    "action": "#56626d",
    "condition": "#8a7a3d",
    "subtree": "#4f7d62",
}


def draw_tree(
    tree: Tree,
    label: Callable[[Node], str],
    is_action: Callable[[Node], bool],
    path: str,
    *,
    apart: bool = False,
    run: LastStatuses | None = None,
    title: str = "",
) -> None:
    """Draw a tree to a file that ends in .svg or .png.

    Named subtrees are framed in place; `apart` draws each once, below the main tree, and so does a tree that would have
    more than 500 nodes. Of more than 2,000 nodes, or 60 levels, the rest is counted only. `run` was a sink of a run,
    whose statuses and values are drawn. `label` and `is_action` are those of a Mission; the `title` is by default the
    name of its file. An .svg file needs no matplotlib. Raises ValueError for another ending, MissionError (BT009,
    BT081).
    """
    kind = picture_ending(path, STILL)
    sheets = Maker(tree, label, is_action, run).sheets(apart)
    title = letters.make_printable(title) or title_of(tree)
    write_file(path, picture_of(sheets, title, kind, path, has_run=run is not None))


def picture_of(sheets: list[Sheet], title: str, kind: str, path: str = "", *, has_run: bool = False) -> bytes:
    """Return the content of a file of the `kind` ".svg" or ".png"; errors name its `path`.

    After a run, nodes have signs.
    """
    with open_drawing(path, kind) as sheet:
        return _TreePicture(sheets, title, has_run, sheet).surface.encode(kind)


class _TreePicture:
    def __init__(
        self, sheets: list[Sheet], title: str, has_run: bool, make_surface: Callable[[float, float, str], Surface]
    ) -> None:
        self._signs = has_run
        layouts = [lay_out(sheet.boxes, has_run) for sheet in sheets]
        pieces = list(zip(sheets, layouts, _arrange(layouts), strict=True))
        width = max(x + layout.width for _, layout, (x, _) in pieces) + _MARGIN
        width = max(width, min(letters.width(title, TITLE, True), _LEAST_WIDE) + 2 * _MARGIN)
        height = max(y + layout.height for _, layout, (_, y) in pieces) + _MARGIN
        if has_run:
            statuses = {box.status for sheet in sheets for box in sheet.boxes}
            looks = [*(look for status, look in LOOKS.items() if status in statuses), NEVER]
            width = max(width, self._legend_width(looks))
            height += _LEGEND + (10 if len(pieces) > 1 else 0)
        self.surface = make_surface(width, height, title)
        title = letters.clip_text(title, width - 2 * _MARGIN, TITLE, True)
        self.surface.text(_MARGIN, _MARGIN + 4, title, size=TITLE, bold=True)
        for sheet, layout, (x, y) in pieces:
            if sheet.name:
                self._frame_of(sheet.name, x, y, layout)
            self._draw(layout, x, y)
        if has_run:
            self._draw_legend(looks, height - _MARGIN - 6)

    def _frame_of(self, name: str, x: float, y: float, layout: TreeLayout) -> None:
        """Draw a titled box around a subtree that is drawn apart."""
        pad = 10.0
        title = letters.clip_text(letters.make_printable(name), max(layout.width, 60.0), TEXT, True)
        self.surface.box(
            x - pad, y - _TITLE, layout.width + 2 * pad, layout.height + _TITLE + pad, round=6, fill="#f8faf8",
            edge=_EDGES["subtree"], line=0.9,
        )  # fmt: skip
        self.surface.text(x, y - _TITLE / 2, title, bold=True, colour=_EDGES["subtree"])

    def _draw(self, layout: TreeLayout, dx: float, dy: float) -> None:
        for spot in layout.spots:
            if spot.box.shape == "frame":
                with self.surface.group(spot.box.text):
                    self._frame(spot, dx, dy)
        for link in layout.links:
            self._link(link, dx, dy)
        for spot in layout.spots:
            if spot.box.shape != "frame":
                with self.surface.group(spot.box.text):
                    self._box(spot, dx, dy)

    def _look(self, spot: Spot) -> Look | None:
        if not self._signs or spot.box.shape == "more":
            return None
        return NEVER if spot.box.status is None else LOOKS[spot.box.status]

    def _frame(self, spot: Spot, dx: float, dy: float) -> None:
        look = self._look(spot)
        edge = look.strong if look else _EDGES["subtree"]
        fill = "#f8faf8"
        x, y = spot.x + dx, spot.y + dy
        self.surface.box(x, y, spot.width, spot.height, round=6, fill=fill, edge=edge, line=1, dashed=look is NEVER)
        if look and look.sign:
            self.surface.text(x + 9, y + FRAME_TITLE / 2 + 1, look.sign, colour=edge, bold=True)
        self.surface.text(x + 9 + (SIGN if look else 0), y + FRAME_TITLE / 2 + 1, spot.lines[0], colour=edge, bold=True)

    def _link(self, link: BoxLink, dx: float, dy: float) -> None:
        points = [(x + dx, y + dy) for x, y in link.points]
        self.surface.line(points, colour=LINE)
        if link.role:
            x, y = points[-1]
            self.surface.text(x - 2.5, y - 5, link.role, size=SMALL, colour=SOFT, align="right")

    def _box(self, spot: Spot, dx: float, dy: float) -> None:
        shape, look = spot.box.shape, self._look(spot)
        x, y, right, bottom = spot.x + dx, spot.y + dy, spot.x + dx + spot.width, spot.y + dy + spot.height
        fill = look.pale if look else _FILLS[shape]
        edge = look.strong if look else _EDGES.get(shape, "none")
        middle = (y + bottom) / 2
        if shape == "decorator":
            points = [(x, middle), (x + 6, y), (right - 6, y), (right, middle), (right - 6, bottom), (x + 6, bottom)]
            self.surface.polygon(points, fill=fill, edge=edge)
        elif shape != "more":
            radius = {"condition": spot.height / 2, "control": 4.0}.get(shape, 0.0)
            self.surface.box(x, y, spot.width, spot.height, round=min(radius, 10.5), fill=fill, edge=edge)
        if shape == "subtree":
            for side in (x + 4, right - 4):
                self.surface.line([(side, y), (side, bottom)], colour=edge)
        self._words(spot, look, x, middle)

    def _words(self, spot: Spot, look: Look | None, x: float, middle: float) -> None:
        shape = spot.box.shape
        bold = shape in ("control", "decorator", "subtree")
        colour = SOFT if look is NEVER or shape == "more" else INK
        x += side(spot.box)
        if look is not None:
            self.surface.text(x - 1.5, middle, look.sign, colour=look.strong, bold=True)
            x += SIGN if look.sign else SIGN / 2
        if spot.box.symbol:
            self.surface.text(x, middle, spot.box.symbol, size=TITLE, bold=True, colour=colour)
            x += SYMBOL
        first = middle - (len(spot.lines) - 1) * LINE_HEIGHT / 2
        for number, line in enumerate(spot.lines):
            self.surface.text(x, first + number * LINE_HEIGHT, line, bold=bold, colour=colour)

    def _legend_width(self, looks: list[Look]) -> float:
        return 2 * _MARGIN + sum(letters.width(look.word, TEXT) + 40 for look in looks)

    def _draw_legend(self, looks: list[Look], y: float) -> None:
        x = _MARGIN
        for look in looks:
            self.surface.box(x, y - 7, 16, 14, round=3, fill=look.pale, edge=look.strong)
            self.surface.text(x + 8, y, look.sign, bold=True, colour=look.strong, align="center")
            self.surface.text(x + 21, y, look.word, colour=SOFT)
            x += letters.width(look.word, TEXT) + 40


def _arrange(layouts: list[TreeLayout]) -> list[tuple[float, float]]:
    """Return upper left corners: the main tree, and below it the subtrees in rows."""
    corners = [(_MARGIN, _MARGIN + HEADING)]
    area = sum((layout.width + 36) * (layout.height + 30 + _TITLE) for layout in layouts)
    room = max(_WIDTH, layouts[0].width, sqrt(area * 1.3))
    x, y, low = _MARGIN + 10, _MARGIN + HEADING + layouts[0].height + 20 + _TITLE, 0.0
    for layout in layouts[1:]:
        if low and x + layout.width > room:
            x, y, low = _MARGIN + 10, low + 30 + _TITLE, 0.0
        corners.append((x, y))
        x += max(layout.width, 60.0) + 36
        low = max(low, y + layout.height)
    return corners


def to_svg(tree: Tree, vocabulary: Lexicon, *, title: str = "") -> str:
    """Return the text of an SVG file, whose `title` is by default the name of the tree's file."""
    return _drawn(tree, vocabulary, ".svg", title).decode()


def to_png(tree: Tree, vocabulary: Lexicon) -> bytes:
    """Return the content of a PNG file. Raises MissionError (BT081)."""
    return _drawn(tree, vocabulary, ".png")


def _drawn(tree: Tree, vocabulary: Lexicon, kind: str, title: str = "") -> bytes:
    sheets = Maker(tree, partial(_label, vocabulary), partial(_is_action, vocabulary)).sheets()
    return picture_of(sheets, make_printable(title) or title_of(tree), kind)


def _label(vocabulary: Lexicon, node: Node) -> str:
    return node.name or phrase_of(node, vocabulary)


def _is_action(vocabulary: Lexicon, node: Node) -> bool:
    entry = vocabulary.entry(node.id)
    return entry is not None and entry.sort == "action"

"""Pictures as SVG, without matplotlib, and what the file of a picture is drawn with."""

from __future__ import annotations

from contextlib import contextmanager
from itertools import pairwise
from operator import itemgetter

from btlang.pictures.letters import CAP_HEIGHT, FAMILY, UNKNOWN
from btlang.pictures.surface import INK, PAPER, TEXT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from btlang.pictures.surface import Points, Surface


_FAMILIES = f"{FAMILY}, Verdana, sans-serif"  # Verdana has nearly the same widths, most others are narrower
_ANCHORS = {"left": None, "center": "middle", "right": "end"}
_FORBIDDEN = (*range(32), *range(0xD800, 0xE000), 0xFFFE, 0xFFFF)  # in XML
_ESCAPES = {**dict.fromkeys(_FORBIDDEN, UNKNOWN), **str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;"})}


class SvgSurface:
    """A Surface that writes SVG."""

    def __init__(self, width: float, height: float, title: str) -> None:
        w, h = _number(width), _number(height)
        self._head = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}pt" height="{h}pt" viewBox="0 0 {w} {h}" '
            f'font-family="{_FAMILIES}" font-size="{TEXT:g}">',
            f"<title>{title.translate(_ESCAPES)}</title>",
        ]
        self._parts: list[tuple[float, str]] = []
        """The lines of the file, each with its `z`."""
        self.box(0, 0, width, height, fill=PAPER)

    def text(
        self, x: float, y: float, text: str, *, size: float = TEXT,
        colour: str = INK, bold: bool = False, align: str = "left", z: float = 0, halo: bool = False,
    ) -> None:  # fmt: skip
        if not text:  # the sign of a node that was never reached
            return
        outline = {"paint_order": "stroke", "stroke": PAPER, "stroke_width": "2.5", "stroke_linejoin": "round"}
        self._add(
            z, "text", text.translate(_ESCAPES), x=x, y=y + size * CAP_HEIGHT / 2, fill=colour,
            font_size=size if size != TEXT else None, font_weight="bold" if bold else None,
            text_anchor=_ANCHORS[align], **(outline if halo else {}),
        )  # fmt: skip

    def box(
        self, x: float, y: float, width: float, height: float, *,
        round: float = 0, fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
    ) -> None:  # fmt: skip
        self._add(
            z, "rect", x=x, y=y, width=width, height=height, rx=round or None, fill=fill,
            **_stroke(edge, line), stroke_dasharray="3 2" if dashed else None,
        )  # fmt: skip

    def polygon(self, points: Points, *, fill: str = "none", edge: str = "none", line: float = 1, z: float = 0) -> None:
        self._add(z, "polygon", points=write_points(points), fill=fill, **_stroke(edge, line), stroke_linejoin="round")

    def circle(
        self, x: float, y: float, radius: float, *,
        fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
    ) -> None:  # fmt: skip
        self._add(
            z, "circle", cx=x, cy=y, r=radius, fill=fill, **_stroke(edge, line),
            stroke_dasharray="2 1.5" if dashed else None,
        )  # fmt: skip

    def line(
        self, points: Points, *,
        colour: str = INK, line: float = 1, dashed: bool = False, round: bool = True, z: float = 0,
    ) -> None:  # fmt: skip
        self._add(
            z, "polyline", points=write_points(points), fill="none", **_stroke(colour, line), stroke_linejoin="round",
            stroke_linecap="round" if round else None,
            stroke_dasharray=f"{_number(2 * line)} {_number(2 * line)}" if dashed else None,
        )  # fmt: skip

    def draw_shaded(self, points: Points, colours: Sequence[str], *, line: float = 1, z: float = 0) -> None:
        for piece, colour in zip(pairwise(points), colours, strict=True):
            self.line(piece, colour=colour, line=line, z=z)

    @contextmanager
    def group(self, title: str) -> Iterator[None]:
        self._parts.append((0, f"<g><title>{title.translate(_ESCAPES)}</title>"))
        yield
        self._parts.append((0, "</g>"))

    def encode(self, kind: str) -> bytes:
        """Return the file. The same picture gives the same bytes."""
        assert kind == ".svg"
        lines = [line for _, line in sorted(self._parts, key=itemgetter(0))]
        return ("\n".join([*self._head, *lines, "</svg>"]) + "\n").encode()

    def _add(self, z: float, tag: str, inner: str = "", /, **attributes: str | float | None) -> None:
        """Add an element.

        Values are numbers, colours and the like, so that nothing has to be escaped. `inner` is XML.
        """
        written = "".join(
            f' {name.replace("_", "-")}="{value if isinstance(value, str) else _number(value)}"'
            for name, value in attributes.items()
            if value is not None
        )
        self._parts.append((z, f"<{tag}{written}>{inner}</{tag}>" if inner else f"<{tag}{written}/>"))


def _stroke(colour: str, line: float = 1) -> dict[str, str | float | None]:
    return {} if colour == "none" else {"stroke": colour, "stroke_width": line if line != 1 else None}


def write_points(points: Points) -> str:
    """Return points as an attribute has them."""
    return " ".join(f"{_number(x)},{_number(y)}" for x, y in points)


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")


@contextmanager
def open_drawing(path: str, kind: str) -> Iterator[Callable[[float, float, str], Surface]]:
    """Give what makes the sheet for a file of a kind: ".svg", or ".png" or ".gif", which matplotlib draws.

    Raises MissionError (BT081) where that is needed and missing.
    """
    if kind == ".svg":
        yield SvgSurface
        return
    from btlang.pictures.canvas import Canvas, with_matplotlib

    with with_matplotlib(path):
        yield Canvas

"""Pictures of trees as SVG, without matplotlib. Text stays text: it can be searched, copied and read aloud."""

from __future__ import annotations

from contextlib import contextmanager

from btlang.pictures.letters import CAP_HEIGHT, FAMILY
from btlang.pictures.style import INK, PAPER, TEXT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

    from btlang.pictures.surface import Points

_FAMILIES = f"{FAMILY}, Verdana, sans-serif"  # Verdana has nearly the same widths, most others are narrower
_ANCHORS = {"left": None, "center": "middle", "right": "end"}
_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;"})


class SvgSurface:
    """A Surface whose texts, all made by `letters.shown`, hold no character that XML forbids."""

    def __init__(self, width: float, height: float, title: str) -> None:
        w, h = _number(width), _number(height)
        self._lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}pt" height="{h}pt" viewBox="0 0 {w} {h}" '
            f'font-family="{_FAMILIES}" font-size="{TEXT:g}">',
            f"<title>{title.translate(_ESCAPES)}</title>",
        ]
        self.box(0, 0, width, height, fill=PAPER)

    def text(
        self, x: float, y: float, text: str, *,
        size: float = TEXT, colour: str = INK, bold: bool = False, align: str = "left",
    ) -> None:  # fmt: skip
        if not text:  # the sign of a node that was never reached
            return
        self._add(
            "text", text, x=x, y=y + size * CAP_HEIGHT / 2, fill=colour, font_size=size if size != TEXT else None,
            font_weight="bold" if bold else None, text_anchor=_ANCHORS[align],
        )  # fmt: skip

    def box(
        self, x: float, y: float, width: float, height: float, *,
        round: float = 0, fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False,
    ) -> None:  # fmt: skip
        self._add(
            "rect", x=x, y=y, width=width, height=height, rx=round or None, fill=fill,
            **_stroke(edge, line), stroke_dasharray="3 2" if dashed else None,
        )  # fmt: skip

    def polygon(self, points: Points, *, fill: str = "none", edge: str = "none") -> None:
        self._add("polygon", points=_joined(points), fill=fill, **_stroke(edge), stroke_linejoin="round")

    def line(self, points: Points, *, colour: str = INK) -> None:
        self._add("polyline", points=_joined(points), fill="none", **_stroke(colour), stroke_linejoin="round")

    @contextmanager
    def group(self, title: str) -> Iterator[None]:
        self._lines.append(f"<g><title>{title.translate(_ESCAPES)}</title>")
        yield
        self._lines.append("</g>")

    def encoded(self, kind: str) -> bytes:
        """The file. The same picture gives the same bytes."""
        assert kind == ".svg"
        return ("\n".join([*self._lines, "</svg>"]) + "\n").encode()

    def _add(self, tag: str, content: str = "", /, **attributes: str | float | None) -> None:
        """Values are numbers, colours and the like, so that only the content has to be escaped."""
        written = "".join(
            f' {name.replace("_", "-")}="{value if isinstance(value, str) else _number(value)}"'
            for name, value in attributes.items()
            if value is not None
        )
        end = f">{content.translate(_ESCAPES)}</{tag}>" if content else "/>"
        self._lines.append(f"<{tag}{written}{end}")


def _stroke(colour: str, line: float = 1) -> dict[str, str | float | None]:
    return {} if colour == "none" else {"stroke": colour, "stroke_width": line if line != 1 else None}


def _joined(points: Points) -> str:
    return " ".join(f"{_number(x)},{_number(y)}" for x, y in points)


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")

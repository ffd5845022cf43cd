"""A surface for pictures as PNG and GIF. All use of matplotlib's figures and fonts is here."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache
from itertools import pairwise
from math import sqrt

from btlang.pictures.files import matplotlib_error
from btlang.pictures.letters import CAP_HEIGHT, FAMILY, UNKNOWN, width
from btlang.pictures.surface import INK, PAPER, TEXT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from matplotlib.artist import Artist
    from matplotlib.font_manager import FontProperties

    from btlang.pictures.surface import Points

_DPI = 144.0
_MOST_PIXELS = 36e6  # of a PNG; a larger picture gets fewer pixels a point
_LONGEST_SIDE = 32000  # pixels; many programs show no more


@cache
def _font(size: float, bold: bool) -> FontProperties:
    from matplotlib.font_manager import FontProperties

    return FontProperties(family=FAMILY, size=size, weight="bold" if bold else "normal")


@cache
def _known() -> frozenset[str]:
    from matplotlib.font_manager import findfont, get_font

    return frozenset(map(chr, get_font(findfont(_font(10, False))).get_charmap()))


@contextmanager
def with_matplotlib(path: str) -> Iterator[None]:
    """Give matplotlib with its own defaults, whatever the user's settings, and without its messages.

    Raises MissionError (BT081) where it cannot be imported.
    """
    logger = logging.getLogger("matplotlib")
    level = logger.level
    logger.setLevel(logging.ERROR)  # "building the font cache" is nobody's concern
    try:
        try:
            from matplotlib import font_manager, style
        except ImportError:
            raise matplotlib_error(path) from None
        assert font_manager.fontManager
        with style.context({"path.simplify": False}, after_reset=True):
            yield
    finally:
        logger.setLevel(level)


class Canvas:
    """A surface of matplotlib. What is drawn later lies above, unless `z` says otherwise."""

    def __init__(self, width: float, height: float, title: str) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self.width, self.height, self._title = width, height, title
        self.figure = Figure(figsize=(width / 72, height / 72), dpi=72, facecolor=PAPER)
        self._agg: Any = FigureCanvasAgg(self.figure)
        self.axes = self.figure.add_axes((0, 0, 1, 1))
        self.axes.set_xlim(0, width)
        self.axes.set_ylim(height, 0)
        self.axes.axis("off")
        self._count = 0
        self._new: list[Artist] = []

    def add(self, artist: Artist, z: float = 0) -> Artist:
        """Add something of matplotlib's."""
        self._count += 1
        artist.set_zorder(z + self._count * 1e-6)
        self._new.append(artist)
        return self.axes.add_artist(artist)

    def text(
        self, x: float, y: float, text: str, *, size: float = TEXT,
        colour: str = INK, bold: bool = False, align: str = "left", z: float = 0, halo: bool = False,
    ) -> Artist:  # fmt: skip
        """Draw one line whose capitals are centred on `y`. A halo keeps it legible above lines."""
        from matplotlib.patheffects import withStroke
        from matplotlib.text import Text

        baseline, known = y + size * CAP_HEIGHT / 2, _known()
        text = "".join(c if c in known else UNKNOWN if width(c, size) else "" for c in text)
        artist = Text(x, baseline, text, color=colour, fontproperties=_font(size, bold), parse_math=False)
        artist.set_horizontalalignment(align)  # type: ignore[arg-type]
        artist.set_verticalalignment("baseline")
        if halo:
            artist.set_path_effects([withStroke(linewidth=2.5, foreground=PAPER)])
        return self.add(artist, z)

    def box(
        self, x: float, y: float, width: float, height: float, *,
        round: float = 0, fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
    ) -> Artist:  # fmt: skip
        """Draw a rectangle with corners rounded to a radius."""
        from matplotlib.patches import FancyBboxPatch

        style = f"round,pad=0,rounding_size={round}" if round else "square,pad=0"
        patch = FancyBboxPatch((x, y), width, height, boxstyle=style, fc=fill, ec=edge, lw=line, mutation_aspect=1)
        patch.set_linestyle((0, (3, 2)) if dashed else "solid")
        return self.add(patch, z)

    def polygon(
        self, points: Points, *, fill: str = "none", edge: str = "none", line: float = 1, z: float = 0
    ) -> Artist:
        """Draw a closed shape."""
        from matplotlib.patches import Polygon

        return self.add(Polygon(points, closed=True, fc=fill, ec=edge, lw=line, joinstyle="round"), z)

    def circle(
        self, x: float, y: float, radius: float, *,
        fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
    ) -> Artist:  # fmt: skip
        """Draw a disc or a ring."""
        from matplotlib.patches import Circle

        return self.add(Circle((x, y), radius, fc=fill, ec=edge, lw=line, ls=(0, (2, 1.5)) if dashed else "solid"), z)

    def line(
        self, points: Points, *,
        colour: str = INK, line: float = 1, dashed: bool = False, round: bool = True, z: float = 0,
    ) -> Artist:  # fmt: skip
        """Draw a line through the points."""
        from matplotlib.lines import Line2D

        xs, ys = [x for x, _ in points], [y for _, y in points]
        end = "round" if round else "butt"
        artist = Line2D(xs, ys, color=colour, lw=line, solid_capstyle=end, solid_joinstyle="round")  # type: ignore[arg-type]
        artist.set_linestyle((0, (2, 2)) if dashed else "solid")
        return self.add(artist, z)

    def draw_shaded(self, points: Points, colours: Sequence[str], *, line: float = 1, z: float = 0) -> Artist:
        """Draw a line through the points whose pieces have a colour each."""
        from matplotlib.collections import LineCollection

        pieces = [list(piece) for piece in pairwise(points)]
        return self.add(LineCollection(pieces, colors=list(colours), linewidths=line, capstyle="round"), z)

    def group(self, title: str) -> AbstractContextManager[object]:
        """Do nothing: shapes have no names here."""
        return nullcontext()

    def begin_film(self, dpi: float) -> None:
        """Draw all that is there; what is added from now on is drawn by `lay`."""
        self.figure.set_dpi(dpi)
        self._agg.draw()
        self._new.clear()
        self.keep()

    def lay(self) -> None:
        """Draw what was added since the last time over the pixels, and take it off the canvas."""
        for artist in sorted(self._new, key=lambda new: new.get_zorder()):
            self.axes.draw_artist(artist)
            artist.remove()
        self._new.clear()

    def keep(self) -> None:
        """Keep what is there now: `restore` brings it back."""
        self._kept = self._agg.copy_from_bbox(self.figure.bbox)

    def restore(self) -> None:
        """Bring back the pixels of the last `keep`."""
        self._agg.restore_region(self._kept)

    def pixels(self) -> tuple[tuple[int, int], bytes]:
        """Return width and height, and the pixels row by row as red, green, blue and opacity."""
        return self._agg.get_width_height(), bytes(self._agg.buffer_rgba())

    def encode(self, kind: str) -> bytes:
        """Return the bytes of a file, `kind` is ".png"; the same picture gives the same bytes."""
        out = io.BytesIO()
        about = {"Title": self._title, "Software": "btlang"}
        self.figure.savefig(out, format=kind[1:], metadata=about, dpi=self._dpi())
        return out.getvalue()

    def _dpi(self) -> float:
        side, area = max(self.width, self.height) / 72, self.width * self.height / 72**2
        return min(_DPI, sqrt(_MOST_PIXELS / area), _LONGEST_SIDE / side)

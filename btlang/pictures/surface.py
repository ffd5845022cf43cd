"""What a picture is drawn on. `SvgSurface` writes SVG itself; `Canvas` is matplotlib's, for PNG and GIF."""

from __future__ import annotations

from btlang.pictures.style import INK, TEXT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from contextlib import AbstractContextManager
    from typing import Protocol

    Points = Sequence[tuple[float, float]]

    class Surface(Protocol):
        """A sheet, in points from the upper left corner. What is drawn later lies above, unless `z` says otherwise."""

        def text(
            self, x: float, y: float, text: str, *, size: float = TEXT,
            colour: str = INK, bold: bool = False, align: str = "left", z: float = 0, halo: bool = False,
        ) -> object:  # fmt: skip
            """One line whose capitals are centred on `y`. `align` says whether it is left, center or right of `x`. A
            halo keeps it legible above lines.
            """

        def box(
            self, x: float, y: float, width: float, height: float, *, round: float = 0,
            fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
        ) -> object:  # fmt: skip
            """A rectangle with corners rounded to a radius."""

        def polygon(
            self, points: Points, *, fill: str = "none", edge: str = "none", line: float = 1, z: float = 0
        ) -> object:
            """A closed shape."""

        def circle(
            self, x: float, y: float, radius: float, *,
            fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
        ) -> object:  # fmt: skip
            """A disc or a ring."""

        def line(
            self, points: Points, *,
            colour: str = INK, line: float = 1, dashed: bool = False, round: bool = True, z: float = 0,
        ) -> object:  # fmt: skip
            """A line through the points."""

        def shaded(self, points: Points, colours: Sequence[str], *, line: float = 1, z: float = 0) -> object:
            """A line through the points whose pieces have a colour each."""

        def group(self, title: str) -> AbstractContextManager[object]:
            """What is drawn within is one thing, which a viewer that can do so names."""

        def encoded(self, kind: str) -> bytes:
            """The bytes of a file of a kind that the surface can make, ".svg" or ".png"."""

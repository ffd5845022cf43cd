"""What a picture of a tree is drawn on. `SvgSurface` writes SVG itself; `Canvas` is matplotlib's, for PNG."""

from __future__ import annotations

from btlang.pictures.style import INK, TEXT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from contextlib import AbstractContextManager
    from typing import Protocol

    Points = Sequence[tuple[float, float]]

    class Surface(Protocol):
        """A sheet, in points from the upper left corner. What is drawn later lies above."""

        def text(
            self, x: float, y: float, text: str, *,
            size: float = TEXT, colour: str = INK, bold: bool = False, align: str = "left",
        ) -> object:  # fmt: skip
            """One line whose capitals are centred on `y`. `align` says whether it is left, center or right of `x`."""

        def box(
            self, x: float, y: float, width: float, height: float, *,
            round: float = 0, fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False,
        ) -> object:  # fmt: skip
            """A rectangle with corners rounded to a radius."""

        def polygon(self, points: Points, *, fill: str = "none", edge: str = "none") -> object:
            """A closed shape."""

        def line(self, points: Points, *, colour: str = INK) -> object:
            """A line through the points."""

        def group(self, title: str) -> AbstractContextManager[object]:
            """What is drawn within is one thing, which a viewer that can do so names."""

        def encoded(self, kind: str) -> bytes:
            """The bytes of a file of a kind that the surface can make, ".svg" or ".png"."""

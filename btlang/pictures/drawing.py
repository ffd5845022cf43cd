"""What the file of a picture is drawn with: matplotlib isn't needed, and isn't loaded, for SVG."""

from __future__ import annotations

from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from btlang.pictures.surface import Surface


@contextmanager
def drawing(path: str, kind: str) -> Iterator[Callable[[float, float, str], Surface]]:
    """Give what makes the sheet for a file of a kind: ".svg", or ".png" or ".gif", which matplotlib draws.

    Raises MissionError (BT081) where that is needed and missing.
    """
    if kind == ".svg":
        from btlang.pictures.svg import SvgSurface

        yield SvgSurface
        return
    from btlang.pictures.canvas import Canvas, with_matplotlib

    with with_matplotlib(path):
        yield Canvas

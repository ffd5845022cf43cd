"""What rich draws, as lines with colours. Importing it imports rich, so only what draws on a terminal does."""

from __future__ import annotations

from collections.abc import Iterator

from rich.color import ColorSystem
from rich.console import Console, RenderableType
from rich.segment import Segment

from btlang.text.escaping import one_line


def lines(drawing: RenderableType, width: int, colour: bool, fold: bool = True) -> Iterator[str]:
    """Lines of at most `width` columns, each made when it is asked for; what is longer is folded, or cut.

    Texts from outside cannot bring escape sequences along; without `colour` there is still bold, dim and the like.
    """
    console = Console(width=width, markup=False, highlight=False, emoji=False)
    options = console.options.update(no_wrap=not fold, overflow="fold" if fold else "ellipsis")
    for line in Segment.split_lines(console.render(drawing, options)):
        pieces = line if colour else Segment.remove_color(line)
        yield "".join(_styled(piece) for piece in Segment.simplify(pieces)).rstrip(" ")


def _styled(piece: Segment) -> str:
    text = one_line(piece.text)
    return piece.style.render(text, color_system=ColorSystem.STANDARD) if piece.style else text

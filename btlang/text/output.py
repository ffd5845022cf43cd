"""The only way to a terminal, which texts of missions, topics and files can't clear or forge."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator

from btlang.text.formatting import one_line, printable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TextIO

    from rich.console import RenderableType
    from rich.segment import Segment


WIDEST = 120  # columns; longer lines are hard to read


def show(text: Any = "", stream: TextIO | None = None, *, end: str = "\n") -> None:
    """Print to a stream, by default standard output, at once. Everything that btlang prints goes through here.

    What is not a `str`, such as a tree or a table, is drawn by rich on a terminal, and `str(text)` elsewhere.
    """
    stream = sys.stdout if stream is None else stream
    if isinstance(text, str) or not can_draw(stream):
        print(printable(str(text)) + end, file=stream, end="", flush=True)  # in one piece: threads print side by side
        return
    print("\n".join(draw_lines(text, columns(80), has_colour(stream))), file=stream, end=end, flush=True)


def pass_on(text: str) -> None:
    """Write a text to standard output as it is, for a file or a program; what a terminal gets is printable."""
    sys.stdout.write(printable(text) if sys.stdout.isatty() else text)


def columns(otherwise: int) -> int:
    """Return the columns of the terminal that standard output is, else so many."""
    from shutil import get_terminal_size

    return get_terminal_size((otherwise, 24)).columns


def listing_width(otherwise: int = 80) -> int:
    """Return the columns for texts that are read line by line: those of the terminal, up to the easily readable."""
    return min(columns(otherwise), WIDEST)


def can_draw(output: TextIO | None) -> bool:
    """Whether an output is a terminal in which a cursor can be moved."""
    return output is not None and output.isatty() and os.environ.get("TERM", "dumb") not in ("", "dumb", "unknown")


def is_unicode(output: TextIO | None) -> bool:
    """Whether an output shows all characters."""
    return output is not None and (output.encoding or "").lower().startswith("utf")


def has_colour(stream: TextIO | None) -> bool:
    """Whether a stream shows colours: a terminal does. NO_COLOR forbids them, FORCE_COLOR and CLICOLOR_FORCE ask for
    them anywhere, CLICOLOR=0 turns them off on a terminal. The first of these that is set decides.
    """
    if os.environ.get("NO_COLOR"):
        return False
    if any(os.environ.get(name, "0") not in ("", "0") for name in ("FORCE_COLOR", "CLICOLOR_FORCE")):
        return True
    if os.environ.get("CLICOLOR") == "0" or os.environ.get("TERM") == "dumb" or stream is None:
        return False
    understands = os.name != "nt" or bool(os.environ.get("WT_SESSION") or os.environ.get("TERM"))
    return understands and stream.isatty()


def draw_lines(drawing: RenderableType, width: int, colour: bool, fold: bool = True) -> Iterator[str]:
    """Draw lines of at most `width` columns, each when it is asked for; what is longer is folded, or cut.

    Texts from outside cannot bring escape sequences along; without `colour` there is still bold, dim and the like.
    """
    from rich.console import Console
    from rich.segment import Segment

    console = Console(width=width, markup=False, highlight=False, emoji=False)
    options = console.options.update(no_wrap=not fold, overflow="fold" if fold else "ellipsis")
    for line in Segment.split_lines(console.render(drawing, options)):
        pieces = line if colour else Segment.remove_color(line)
        yield "".join(_style(piece) for piece in Segment.simplify(pieces)).rstrip(" ")


def _style(piece: Segment) -> str:
    from rich.color import ColorSystem

    text = one_line(piece.text)
    return piece.style.render(text, color_system=ColorSystem.STANDARD) if piece.style else text

"""The one way to a terminal: texts of missions, topics and files must not clear its screen or forge its lines."""

from __future__ import annotations

import os
import sys

from btlang.text.escaping import printable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TextIO

WIDEST = 120  # columns; longer lines are hard to read


def show(text: Any = "", stream: TextIO | None = None, *, end: str = "\n") -> None:
    """Prints to a stream, by default standard output, at once. Everything that btlang prints goes through here.

    What is not a `str`, such as a tree or a table, is drawn by rich on a terminal, and `str(text)` elsewhere.
    """
    stream = sys.stdout if stream is None else stream
    if isinstance(text, str) or not can_draw(stream):
        print(printable(str(text)) + end, file=stream, end="", flush=True)  # in one piece: threads print side by side
        return
    from btlang.text.drawing import lines

    print("\n".join(lines(text, columns(80), has_colour(stream))), file=stream, end=end, flush=True)


def pass_on(text: str) -> None:
    """Writes a text to standard output as it is, for a file or a program; what a terminal gets is printable."""
    sys.stdout.write(printable(text) if sys.stdout.isatty() else text)


def columns(otherwise: int) -> int:
    """Of the terminal that standard output is, else so many."""
    from shutil import get_terminal_size

    return get_terminal_size((otherwise, 24)).columns


def listing_width(otherwise: int = 80) -> int:
    """Columns for texts that are read line by line: those of the terminal, as far as lines are easy to read."""
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

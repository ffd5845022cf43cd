"""Texts for people: control characters made visible, lists such as `A, B and C`, ordinal numbers, and columns."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rich.console import RenderableType


RED, YELLOW, CYAN, PLAIN = "\x1b[1;31m", "\x1b[1;33m", "\x1b[36m", "\x1b[0m"
"""The only escape sequences that `printable` lets through."""
_COLOURS = (RED, YELLOW, CYAN, PLAIN)
_JOINERS = "\u200c\u200d"  # without which some scripts and emoji fall apart
NTH = {1: "st", 2: "nd", 3: "rd"}
"""What stands behind the figures of an ordinal number; behind all others it is `th`."""


def printable(text: str) -> str:
    """Return the text with `\\x1b` and the like in place of control characters, but for line ends, tabs and own
    colours.
    """
    return "\n".join(line if line.isprintable() else _printable(line) for line in text.split("\n"))


def _printable(text: str) -> str:
    parts = []
    at = 0
    while at < len(text):
        colour = next((colour for colour in _COLOURS if text.startswith(colour, at)), "") if text[at] == "\x1b" else ""
        parts.append(colour or _escape(text[at], "\t"))
        at += len(colour) or 1
    return "".join(parts)


def one_line(text: str) -> str:
    """Return the text on one line: line ends, tabs and escape sequences are shown, too."""
    return text if text.isprintable() else "".join(_escape(c, "") for c in text)


def _escape(character: str, kept: str) -> str:
    """Escape what could move the cursor, turn the direction of reading or begin a line; blanks of any width stay."""
    blank = character > "\x9f" and character.isspace() and character not in "\u2028\u2029"
    if character.isprintable() or blank or character in kept or character in _JOINERS:
        return character
    return character.encode("unicode_escape").decode("ascii")


def joined(words: Sequence[str], last: str = "and") -> str:
    """Join words with commas, and a word before the last one: `A, B and C`."""
    return f" {last} ".join((", ".join(words[:-1]), words[-1])) if len(words) > 1 else "".join(words)


def nth(number: int) -> str:
    """Return `2nd`; of a negative number, which counts from the last one, `last` or `2nd last`."""
    if number == -1:
        return "last"
    size = abs(number)
    ending = "th" if size % 100 in (11, 12, 13) else NTH.get(size % 10, "th")
    return f"{size}{ending}{' last' if number < 0 else ''}"


class TextTable(Record):
    """Rows of equally many texts, shown below each other.

    As a text, columns are as wide as their texts and at least `widths`, `gap` apart; on a terminal rich folds them.
    """

    rows: tuple[tuple[str, ...], ...]
    widths: tuple[int, ...] = ()
    gap: int = 2
    indent: int = 0

    def __str__(self) -> str:
        widest = [max(map(len, column)) for column in zip(*self.rows, strict=True)][:-1]
        least = (*self.widths, *[0] * len(widest))
        widths = [max(pair) + self.gap for pair in zip(widest, least, strict=False)]
        heads = ("".join(map(str.ljust, row, widths)) for row in self.rows)
        return "\n".join(f"{' ' * self.indent}{head}{row[-1]}" for head, row in zip(heads, self.rows, strict=True))

    def __rich__(self) -> RenderableType:
        from rich.padding import Padding
        from rich.table import Table as Grid
        from rich.text import Text

        grid = Grid.grid(padding=(0, self.gap, 0, 0))
        for row in self.rows:
            grid.add_row(*(Text(text, overflow="fold") for text in row))
        return Padding(grid, (0, 0, 0, self.indent))

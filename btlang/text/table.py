"""Rows of texts in columns."""

from __future__ import annotations

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rich.console import RenderableType


class Table(Record):
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

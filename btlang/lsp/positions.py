"""Positions of the protocol: lines from 0, and columns in UTF-16 units; lines end with LF, CR LF or CR."""

from __future__ import annotations

import re
from bisect import bisect_right

from lsprotocol.types import Position, Range

from btlang.text.source import Utf16Units

_END = re.compile(r"\r\n|\n|\r")


class TextPositions:
    """The lines of one text. Positions outside of it are taken for the nearest ones inside."""

    def __init__(self, text: str) -> None:
        self._text = text
        ends = [found.span() for found in _END.finditer(text)]
        self._starts = [0, *(end for _, end in ends)]
        self._ends = [*(start for start, _ in ends), len(text)]

    def position(self, at: int) -> Position:
        """Return the position of a character."""
        line = bisect_right(self._starts, at) - 1
        start = self._starts[line]
        return Position(line, Utf16Units(self._text[start : min(at, self._ends[line])]).length)

    def offset(self, position: Position) -> int:
        """Return the character at a position."""
        if position.line >= len(self._starts):
            return len(self._text)
        start, end = self._starts[position.line], self._ends[position.line]
        return min(start + Utf16Units(self._text[start:end]).character(position.character), end)

    def range(self, start: int, end: int) -> Range:
        """Return the range of some characters."""
        return Range(self.position(start), self.position(end))

    def offsets(self, range: Range) -> tuple[int, int]:
        """Return the characters of a range; one that ends before it starts is empty."""
        start = self.offset(range.start)
        return start, max(start, self.offset(range.end))

"""Source texts and places in them: spans, lines of Python that call btlang, and UTF-16 units as pages count them."""

from __future__ import annotations

import os
import sys
from bisect import bisect_left, bisect_right
from itertools import accumulate

from btlang.support.record import Record

_sources: dict[str, tuple[list[str], PythonSource]] = {}  # by file names, with the lines that linecache gave
_LAST = "\uffff"  # of the characters that have one unit


class Source:
    """A text to compile. `name` is what messages show: a path, `-` or `<text>`.

    What the text includes is looked for in `folder`, by default that of the path. It has to lie below one of the
    folders `roots`, by default `folder`; with () nothing can be included. Messages show nothing of a `hidden` text but
    places in it; with `hides_includes`, what the text includes is hidden, since its author may not read these files.
    A text that the user named or typed `may_load` the keyword files that it names, which run Python.
    """

    __slots__ = ("_starts", "folder", "hidden", "hides_includes", "may_load", "name", "roots", "text")

    def __init__(
        self,
        text: str,
        name: str = "<text>",
        folder: str | None = None,
        roots: tuple[str, ...] | None = None,
        *,
        hidden: bool = False,
        hides_includes: bool = False,
        may_load: bool = False,
    ) -> None:
        self.text = text
        self.name = name
        self.folder = os.path.dirname(name) if folder is None else folder
        self.roots = (self.folder,) if roots is None else roots
        self.hidden = hidden
        self.hides_includes = hides_includes
        self.may_load = may_load
        self._starts: list[int] | None = None

    def with_text(self, text: str) -> Source:
        """Return a source with another text in its place."""
        return Source(
            text, self.name, self.folder, self.roots,
            hidden=self.hidden, hides_includes=self.hides_includes, may_load=self.may_load,
        )  # fmt: skip

    def position(self, offset: int) -> tuple[int, int]:
        """Return line and column of a character offset, both from 1, as editors count them."""
        starts = self._line_starts()
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1

    def offset(self, line: int, column: int = 1) -> int:
        """Return the character at a line and column (both from 1), at most the end of the text."""
        starts = self._line_starts()
        return min(starts[min(line, len(starts)) - 1] + column - 1, len(self.text))

    def line(self, number: int) -> str:
        """Return the text of a line (from 1) without its end."""
        starts = self._line_starts()
        end = starts[number] if number < len(starts) else len(self.text)
        return self.text[starts[number - 1] : end].rstrip("\r\n")

    def _line_starts(self) -> list[int]:
        if self._starts is None:
            lengths = map(len, self.text.split("\n"))
            self._starts = [0, *accumulate(n + 1 for n in lengths)][:-1]
        return self._starts


class PythonSource(Source):
    """The text of a Python script: its lines make nodes and words, but don't say them in English."""

    __slots__ = ()


class Span(Record, uncompared=("source",)):
    """The characters `start` to `end` (exclusive) of a source."""

    source: Source
    start: int
    end: int

    @property
    def text(self) -> str:
        """The words as they were written."""
        return self.source.text[self.start : self.end]

    @property
    def place(self) -> str:
        """`file:line:column`, as compilers print it."""
        line, column = self.source.position(self.start)
        return f"{self.source.name}:{line}:{column}"


NOWHERE = Span(Source(""), 0, 0)
"""Where a message points that is about no text."""


def find_calling_line() -> Span | None:
    """Return the line, outside this package, of the innermost call into it. None if the text of its file isn't
    known.

    Of a call of several lines it is the first.
    """
    from linecache import getlines

    frame = sys._getframe(1)
    while frame.f_globals.get("__name__", "").startswith("btlang."):
        if frame.f_back is None:
            return None
        frame = frame.f_back
    file, number = frame.f_code.co_filename, frame.f_lineno
    lines = getlines(file)
    if not 0 < number <= len(lines):
        return None
    known = _sources.get(file)
    if known is None or known[0] is not lines:  # linecache has read a newer text
        known = _sources[file] = lines, PythonSource("".join(lines), file)
    source = known[1]
    words = lines[number - 1].strip()
    start = source.offset(number, 1 + lines[number - 1].find(words))
    return Span(source, start, start + len(words))


class Utf16Units:
    """The UTF-16 units of one text. A character beyond the first 65,536 is two."""

    def __init__(self, text: str) -> None:
        is_wide = not text.isascii() and max(text) > _LAST
        self.wide = [at for at, character in enumerate(text) if character > _LAST] if is_wide else []
        """The characters that have two units."""
        self._before = [at + number for number, at in enumerate(self.wide)]
        self.length = len(text) + len(self.wide)

    def unit(self, at: int) -> int:
        """Return the unit where a character begins."""
        return at + bisect_left(self.wide, at)

    def character(self, unit: int) -> int:
        """Return the character that a unit is part of."""
        return unit - bisect_left(self._before, unit)

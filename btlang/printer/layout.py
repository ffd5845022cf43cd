"""The canonical layout of a mission: indentation, spaces and empty lines. Words, comments and line ends stay.

Two spaces a block level, and four more where a line goes on with the one before it; one space between words; none
before `,` `;` `:` `.` `)` and behind `(`; two before a comment behind a command; nothing at the ends of lines; at most
one empty line in a row and none at the ends of the text.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator

from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import Line, Orthography, Words, split

INDENT = "  "
_BLANK = r"[\s\ufeff]"
# Outside quotes: blanks, an end of a statement, another mark, a bracket that opens, or anything else; the `.` of a
# number is part of it.
_PIECE = re.compile(
    rf"(?P<blank>{_BLANK}+)|(?P<close>[,;)]|(?<!\d):|:(?!\d)|(?:(?<!\d)\.|\.(?!\d)|[!?])+)|(?P<open>\()"
    rf"|(?P<other>(?:(?!{_BLANK})[^,;:().!?]|(?<=\d)[.:](?=\d))+)"
)
_MARGIN = re.compile(rf"{_BLANK}*")


class _Row(Record):
    """A line of the text: its content without the margin, the column where that starts, its words if any.

    One that `goes_on` has the words of the line before it.
    """

    content: str
    column: int
    words: Line | None
    goes_on: bool = False


def format_layout(source: Source, orthography: Orthography) -> str:
    """Return the text in its canonical layout, which doesn't change when it is formatted again. It must have no
    errors.

    Its words are the same ones, so it has the same tree.
    """
    rows = list(_rows(source, split(source, orthography)))
    levels = _levels(rows)
    lines: list[str] = []
    for row, level in zip(rows, levels, strict=True):
        if row.content or (lines and lines[-1]):
            lines.append(INDENT * level + row.content if row.content else "")
    while lines and not lines[-1]:
        lines.pop()
    return "".join(f"{line}\n" for line in lines)


def _rows(source: Source, words: Words) -> Iterator[_Row]:
    """Yield each line with its content in the canonical layout."""
    quotes = [
        (start, end)
        for word, start, end in zip(words.words, words.starts, words.ends, strict=True)
        if word.startswith('"') or source.text.find(",", start, end - 1) > start  # `1,5` is one number
    ]
    waiting = words.lines[::-1]
    at, last = 0, -1  # where the words of the line end that has begun
    for text in source.text.split("\n"):
        end = at + len(text)
        inside = quotes[bisect_left(quotes, (at, at)) : bisect_left(quotes, (end, end))]
        content = _content(text, [(start - at, stop - at) for start, stop in inside])
        column = len(_MARGIN.match(text).group().replace("\r", "").expandtabs(4))  # type: ignore[union-attr]
        begins = bool(waiting) and words.starts[waiting[-1].first] <= end
        yield _Row(content, column, waiting[-1] if begins else None, not begins and at <= last)
        if begins:
            last = words.ends[waiting.pop().last]
        at = end + 1


def _content(line: str, quotes: list[tuple[int, int]]) -> str:
    """Return a line without its margin: its words with one space between them, and its comment."""
    parts: list[str] = []
    tight = True  # no space follows the begin or a bracket that opens
    for kind, text in _pieces(line, quotes):
        if kind == "comment":
            parts += [INDENT if parts else "", text]
        else:
            parts += ["" if tight or kind == "close" else " ", text]
        tight = kind == "open"
    return "".join(parts)


def _pieces(line: str, quotes: list[tuple[int, int]]) -> Iterator[tuple[str, str]]:
    at = 0
    for start, end in [*quotes, (len(line), len(line))]:
        comment = line.find("#", at, start)
        for match in _PIECE.finditer(line, at, start if comment < 0 else comment):
            if match.lastgroup != "blank":
                yield str(match.lastgroup), match.group()
        if comment >= 0:
            yield "comment", re.sub(rf"{_BLANK}+$", "", line[comment:])
            return
        if start < end:
            yield "quote", line[start:end]
        at = end


def _levels(rows: list[_Row]) -> list[int]:
    """Return the block level of each line. A line without words goes with the lines around it, by its column."""
    levels = [0] * len(rows)
    columns: list[int] = []  # of the blocks that are open, the outermost first
    waiting: list[int] = []  # lines without words, until the next words come
    for i, row in enumerate(rows):
        if row.goes_on:
            levels[i] = levels[i - 1] + (0 if rows[i - 1].goes_on else 2)
            continue
        if row.words is None:
            if row.content:
                waiting.append(i)
            continue
        before = list(columns)
        while columns and row.words.indent < columns[-1]:
            columns.pop()
        if not columns or row.words.indent > columns[-1]:
            columns.append(row.words.indent)
        levels[i] = len(columns) - 1
        _settle(waiting, rows, levels, before if len(before) > len(columns) else columns, levels[i], len(before) - 1)
        waiting.clear()
    _settle(waiting, rows, levels, columns, 0, len(columns) - 1)
    return levels


def _settle(waiting: list[int], rows: list[_Row], levels: list[int], columns: list[int], one: int, other: int) -> None:
    """Set the levels of lines without words between lines of two levels."""
    lowest, highest = min(one, max(other, 0)), max(one, other)
    for i in waiting:
        fitting = [level for level, column in enumerate(columns) if column <= rows[i].column]
        levels[i] = min(max(fitting[-1] if fitting else 0, lowest), highest)

"""Texts as a client has them: what the protocol says of lines and UTF-16 units, without the code of the server."""

from __future__ import annotations

import re


def position_of(text: str, at: int) -> tuple[int, int]:
    """The line and the column of a character; of one inside CR LF those of the CR."""
    if text[at - 1 : at + 1] == "\r\n" and at:
        at -= 1
    before = re.split(r"\r\n|\r|\n", text[:at] + ("x" if text[at : at + 1] else ""))
    last = before[-1][:-1] if text[at : at + 1] else before[-1]
    return len(before) - 1, len(last.encode("utf-16-le")) // 2


def changed(text: str, place: tuple[int, int, int, int], new: str) -> str:
    """The text with a range replaced."""
    start, end = unit_of(text, *place[:2]), unit_of(text, *place[2:])
    units = text.encode("utf-16-le")
    return (units[: 2 * start] + new.encode("utf-16-le") + units[2 * end :]).decode("utf-16-le")


def unit_of(text: str, line: int, column: int) -> int:
    """The number of code units before a position."""
    parts = re.findall(r"[^\r\n]*(?:\r\n|\r|\n|\Z)", text)
    return sum(len(part.encode("utf-16-le")) // 2 for part in parts[:line]) + column

"""Changes of a text."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.support.record import Record


class Change(Record):
    """A change: the characters `start` to `end` (exclusive) of a text become others."""

    start: int
    end: int
    text: str


def changed(text: str, changes: Iterable[Change]) -> str:
    """Return the text with the changes, which are in order and don't overlap."""
    parts: list[str] = []
    at = 0
    for change in changes:
        parts += [text[at : change.start], change.text]
        at = change.end
    return "".join((*parts, text[at:]))

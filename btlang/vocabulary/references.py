"""References to values of the mission in port texts: `{level}` alone, or inside a text: `it is {level} percent`.

In a text `{{` and `}}` are the characters themselves.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from btlang.record import Record

_PIECE = r"(?P<mark>\{\{|\}\})|\{(?P<name>[^{}]+)\}|(?P<text>[^{}]+|[{}])"  # compiled when a text needs it


class Reference(Record):
    """A value of the mission, by its key on the blackboard."""

    key: str


def pieces(text: str) -> list[str | Reference]:
    """What a text is made of: plain parts, as they will be, and references. Never two plain parts in a row."""
    if "{" not in text and "}" not in text:
        return [text] if text else []
    found: list[str | Reference] = []
    for match in re.finditer(_PIECE, text):
        if match["name"] is not None:
            found.append(Reference(match["name"]))
            continue
        plain = match["text"] or match["mark"][0]
        if found and isinstance(found[-1], str):
            found[-1] += plain
        else:
            found.append(plain)
    return found


def keys_in(text: str) -> Iterator[str]:
    """The keys that a port text refers to, in their order."""
    if "{" in text:
        yield from (piece.key for piece in pieces(text) if isinstance(piece, Reference))


def renamed(text: str, key: Callable[[str], str]) -> str:
    """The same text with each name in braces replaced by its key."""
    return re.sub(_PIECE, lambda match: f"{{{key(match['name'])}}}" if match["name"] is not None else match[0], text)


def plain(text: str) -> str:
    """The port text that stands for exactly this text."""
    return text.replace("{", "{{").replace("}", "}}")

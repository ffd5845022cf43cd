"""Grammars in the EBNF of the W3C, as the specification of XML defines it."""

from __future__ import annotations

import re

from btlang.backends.grammar.rules import Chars, Choice, Joined, Name, Part, Repeated, Rules, Text


def to_ebnf(rules: Rules) -> str:
    """One rule on each line; the first makes whole missions."""
    return "".join(f"{name} ::= {_written(part)}\n" for name, part in rules.items())


def _written(part: Part, inside: bool = False) -> str:
    """A part, in brackets where it is `inside` another one that binds tighter."""
    if isinstance(part, Text):
        pieces = [_quoted(piece) for piece in re.split(r'(\n|"+)', part.text) if piece]
        return f"({' '.join(pieces)})" if inside and len(pieces) > 1 else " ".join(pieces)
    if isinstance(part, Chars):
        return part.written
    if isinstance(part, Name):
        return part.name
    if isinstance(part, Repeated):
        return _written(part.part, inside=True) + part.mark
    if isinstance(part, Joined):
        text = " ".join(_written(each, isinstance(each, Choice)) for each in part.parts)
    else:
        text = " | ".join(map(_written, part.parts))
    return f"({text})" if inside else text


def _quoted(piece: str) -> str:
    """A text has no escapes: a line end is a code, and a double quote stands in single ones."""
    if piece == "\n":
        return "#xA"
    return f"'{piece}'" if '"' in piece else f'"{piece}"'

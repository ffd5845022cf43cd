"""Grammars in the EBNF of the W3C, as the specification of XML defines it."""

from __future__ import annotations

import re

from btlang.backends.grammar.rules import Rules, written


def to_ebnf(rules: Rules) -> str:
    """One rule on each line; the first makes whole missions."""
    return written(rules, lambda text: [_quoted(piece) for piece in re.split(r'(\n|"+)', text) if piece])


def _quoted(piece: str) -> str:
    """A text has no escapes: a line end is a code, and a double quote stands in single ones."""
    if piece == "\n":
        return "#xA"
    return f"'{piece}'" if '"' in piece else f'"{piece}"'

"""Grammars in GBNF, the notation of llama.cpp."""

from __future__ import annotations

from btlang.backends.grammar.rules import Rules, written

_ESCAPES = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n"})


def to_gbnf(rules: Rules) -> str:
    """One rule on each line. The first must be called "root"."""
    return written(rules, lambda text: [f'"{text.translate(_ESCAPES)}"'])

"""Grammars in GBNF, the notation of llama.cpp."""

from __future__ import annotations

from btlang.backends.grammar.rules import Chars, Choice, Joined, Name, Part, Repeated, Rules, Text

_ESCAPES = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n"})


def to_gbnf(rules: Rules) -> str:
    """One rule on each line. The first must be called "root"."""
    return "".join(f"{name} ::= {_written(part)}\n" for name, part in rules.items())


def _written(part: Part, inside: bool = False) -> str:
    """A part, in brackets where it is `inside` another one that binds tighter."""
    if isinstance(part, Text):
        return f'"{part.text.translate(_ESCAPES)}"'
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

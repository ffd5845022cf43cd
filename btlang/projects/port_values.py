"""Texts as values of C++ types, as BehaviorTree.CPP converts them."""

from __future__ import annotations

import re

_INTEGER = re.compile(r"(?:std::)?(?P<unsigned>u|unsigned )?(?:int|long|short|long long|int(?P<bits>8|16|32|64)_t)")
_ALONE = {"unsigned": (0, 2**32 - 1), "size_t": (0, 2**64 - 1), "std::size_t": (0, 2**64 - 1)}
_BITS = {"short": 16, "long": 64, "long long": 64}
_DECIMAL = ("double", "float")
_NUMBER = re.compile(r"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|inf|nan)", re.IGNORECASE)
_BOOL = frozenset(("0", "1", "true", "True", "TRUE", "false", "False", "FALSE"))
_ENUM = re.compile(r"(?:enum\b[\w ]*)?[({\[]?\s*(\w+(?:\s*[|,;]\s*\w+)+)\s*[)}\]]?")


def wanted(text: str, type: str) -> str:
    """What a value of the type is, where the text is none; "" where it is one, or nothing is known of the type."""
    if text[:5] == "json:":
        return ""
    bounds = _bounds(type)
    if bounds is not None:
        least, most = bounds
        is_whole = re.fullmatch(r"[+-]?\d{1,30}", text) is not None
        return "" if is_whole and least <= int(text) <= most else f"a whole number from {least:,} to {most:,}"
    if type in _DECIMAL:
        return "" if _NUMBER.fullmatch(text) else "a number"
    if type == "bool":
        return "" if text in _BOOL else "true or false"
    names = enum_names(type)
    return "" if not names or text in names or text.isdecimal() else f"one of {', '.join(names)}"


def enum_names(type: str) -> list[str]:
    """The names of an enum whose type lists them, such as `LEFT|RIGHT`; none for any other type."""
    listed = _ENUM.fullmatch(type.strip())
    return re.split(r"\s*[|,;]\s*", listed[1]) if listed else []


def _bounds(type: str) -> tuple[int, int] | None:
    """The least and the greatest value of a type of whole numbers."""
    if type in _ALONE:
        return _ALONE[type]
    match = _INTEGER.fullmatch(type)
    if match is None:
        return None
    name = type.removeprefix("unsigned ")
    bits = int(match["bits"] or 0) or _BITS.get(name, 32)
    return (0, 2**bits - 1) if match["unsigned"] else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)

"""Lists and ordinal numbers in messages: `A, B and C`, `2nd`."""

from __future__ import annotations

from collections.abc import Sequence

NTH = {1: "st", 2: "nd", 3: "rd"}
"""What stands behind the figures of an ordinal number; behind all others it is `th`."""


def joined(words: Sequence[str], last: str = "and") -> str:
    """Words with commas between them, and a word before the last one: `A, B and C`."""
    return f" {last} ".join((", ".join(words[:-1]), words[-1])) if len(words) > 1 else "".join(words)


def nth(number: int) -> str:
    """`2nd`; of a negative number, which counts from the last one, `last` or `2nd last`."""
    if number == -1:
        return "last"
    size = abs(number)
    ending = "th" if size % 100 in (11, 12, 13) else NTH.get(size % 10, "th")
    return f"{size}{ending}{' last' if number < 0 else ''}"

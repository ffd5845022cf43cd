"""Places in a text as pages count them: in UTF-16 units. A character beyond the first 65,536 is two."""

from __future__ import annotations

from bisect import bisect_left

_LAST = "\uffff"  # of the characters that have one unit


class Units:
    """Counts in one text."""

    def __init__(self, text: str) -> None:
        is_wide = not text.isascii() and max(text) > _LAST
        self.wide = [at for at, character in enumerate(text) if character > _LAST] if is_wide else []
        """The characters that have two units."""
        self._before = [at + number for number, at in enumerate(self.wide)]
        self.length = len(text) + len(self.wide)

    def unit(self, at: int) -> int:
        """Where a character begins."""
        return at + bisect_left(self.wide, at)

    def character(self, unit: int) -> int:
        """The character that a unit is part of."""
        return unit - bisect_left(self._before, unit)

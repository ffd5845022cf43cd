"""Places in a text as pages count them: in UTF-16 units. A character beyond the first 65,536 is two."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping

from btlang.editing.changes import Change, changed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

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


def in_units(answer: dict[str, Any], text: str) -> dict[str, Any]:
    """An answer about a text with its places in units: all that is called `start`, `end` or `of`.

    Where it has `changes`, its own `start` and `end` are in the text with them.
    """
    units = Units(text)
    made: dict[str, Any] = _converted(answer, units) if units.wide else answer
    if "changes" in answer and "start" in answer:
        after = Units(changed(text, [Change(**change) for change in answer["changes"]]))
        made = {**made, "start": after.unit(answer["start"]), "end": after.unit(answer["end"])}
    return made


def _converted(part: Any, units: Units) -> Any:
    if isinstance(part, Mapping):
        return {
            key: _place(value, units) if key in ("start", "end", "of") else _converted(value, units)
            for key, value in part.items()
        }
    return [_converted(each, units) for each in part] if isinstance(part, list | tuple) else part


def _place(value: Any, units: Units) -> Any:
    if isinstance(value, int):
        return units.unit(value)
    return [units.unit(each) for each in value] if value is not None else None

"""Answers about a text whose places are counted as pages count them: in UTF-16 units."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.editing.changes import Change, changed
from btlang.text.utf16 import Units

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


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

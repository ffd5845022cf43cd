"""Which values of JSON stores, files and messages of ROS 2 can keep."""

from __future__ import annotations

import math

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def can_be_kept(value: Any) -> bool:
    """Whether they take all texts and numbers in a value."""
    waiting = [value]
    while waiting:
        each = waiting.pop()
        if isinstance(each, dict):
            waiting += [*each.keys(), *each.values()]
        elif isinstance(each, list | tuple):
            waiting += each
        elif (isinstance(each, float) and not math.isfinite(each)) or (isinstance(each, str) and not is_whole(each)):
            return False
    return True


def is_whole(text: str) -> bool:
    """Whether it has no NUL and no half of a character."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return "\0" not in text

"""Reads JSON from outside: Python's reader recurses in C, and would crash where an engine has raised its limit."""

from __future__ import annotations

import re

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

DEEPEST = 100
"""Brackets in each other."""
_MARKS = re.compile(r'"(?:[^"\\]|\\.)*+"?|[\[{]|[\]}]', re.DOTALL)  # a text that does not end is read once, too


class NestedTooDeep(ValueError):
    """A document with more than DEEPEST brackets in each other."""


def load_json(text: str | bytes, object_hook: Callable[[dict[str, Any]], Any] | None = None) -> Any:
    """As `json.loads`. Raises ValueError for what isn't JSON, NestedTooDeep among these."""
    import json

    if isinstance(text, bytes):
        text = text.decode(json.detect_encoding(text), "surrogatepass")
    depth = 0
    for found in _MARKS.finditer(text) if text.count("[") + text.count("{") > DEEPEST else ():
        mark = found[0]
        depth += (mark in "[{") - (mark in "]}")
        if depth > DEEPEST:
            raise NestedTooDeep("it is nested too deep")
    return json.loads(text, object_hook=object_hook)

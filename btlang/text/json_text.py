"""JSON of unknown depth. Python's own parser recurses in C, and would crash where an engine has raised the limit."""

from __future__ import annotations

import re

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

DEEPEST = 100
"""Brackets in each other."""
_DEEP = "(nested too deep)"
_MARKS = re.compile(r'"(?:[^"\\]|\\.)*+"?|[\[{]|[\]}]', re.DOTALL)  # a text that does not end is read once, too


class NestedTooDeep(ValueError):
    """An error about a document, or a value, with more than DEEPEST brackets in each other."""


def load_json(text: str | bytes, object_hook: Callable[[dict[str, Any]], Any] | None = None) -> Any:
    """Load a text as `json.loads` does. Raises ValueError for what isn't JSON, NestedTooDeep among these."""
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


def dump_json(value: Any, default: Callable[[Any], Any] | None = None, **options: Any) -> str:
    """Dump a value as `json.dumps` does. Raises NestedTooDeep for what `load_json` wouldn't read."""
    import json

    if is_deep(value):
        raise NestedTooDeep("it is nested too deep")
    return json.dumps(value, default=default, **options)


def is_deep(value: Any) -> bool:
    """Whether JSON would have more than DEEPEST brackets in each other."""
    outer = [value]
    for _ in range(DEEPEST + 1):
        outer = [each for each in outer if isinstance(each, dict | list | tuple)]
        if not outer:
            return False
        inner = (item for each in outer for item in (each.values() if isinstance(each, dict) else each))
        outer = [*{id(item): item for item in inner}.values()]  # what is twice in a list, and that twice in another ...
    return True


def shallow(values: Any) -> Any:
    """Return values by name, or another value, with a text in place of what is nested too deep."""
    if isinstance(values, dict):
        return {name: _DEEP if is_deep([[value]]) else value for name, value in values.items()}
    return _DEEP if is_deep(values) else values

"""The types of the fields of commands."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_NUMBER, _TEXT, _TEXTS = {"type": "number"}, {"type": "string"}, {"type": "array", "items": {"type": "string"}}
FIELD_TYPES: dict[str, tuple[Any, dict[str, Any]]] = {
    "str": (str, _TEXT),
    "int": (int, {"type": "integer"}),
    "int | None": (int | None, {"type": ["integer", "null"]}),
    "float | None": (int | float | None, {"type": ["number", "null"]}),
    "str | float | None": (str | int | float | None, {"type": ["string", "number", "null"]}),
    "tuple[str, ...]": (list, _TEXTS),
    "Mapping[str, Any]": (dict, {"type": "object"}),
}
"""By the annotations of the fields: what JSON gives for them, and how the schema describes that."""

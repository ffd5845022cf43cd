"""The types of the fields of events and commands."""

from __future__ import annotations

from functools import cache
from types import NoneType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_KINDS: dict[str, tuple[Any, str]] = {
    "str": (str, "string"),
    "int": (int, "integer"),
    "float": (int | float, "number"),
    "bool": (bool, "boolean"),
    "None": (NoneType, "null"),
}


@cache
def field_type(annotation: str) -> tuple[Any, dict[str, Any]]:
    """Return what JSON gives for an annotated field, for isinstance, and the JSON schema of it.

    Raises KeyError for an annotation that JSON has nothing for.
    """
    if annotation == "Any":
        return object, {}
    outer, _, inner = annotation.removesuffix("]").partition("[")
    if outer == "Mapping":
        values = field_type(inner.removeprefix("str, "))[1]
        return dict, {"type": "object", **({"additionalProperties": values} if values else {})}
    if outer == "tuple":
        return list, {"type": "array", "items": field_type(inner.removesuffix(", ..."))[1]}
    kinds = [_KINDS[each] for each in annotation.split(" | ")]
    names = [name for _, name in kinds]
    return tuple(kind for kind, _ in kinds), {"type": names if names[1:] else names[0]}

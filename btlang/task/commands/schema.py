"""The JSON schema of commands, made from their classes."""

from __future__ import annotations

from btlang.support.field_types import field_type
from btlang.task.messages import COMMANDS, Command

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of a command."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A command for a robot of btlang",
        "oneOf": [_describe(kind) for kind in COMMANDS.values()],
    }


def _describe(kind: type[Command]) -> dict[str, Any]:
    fields = {field: field_type(kind.__annotations__[field])[1] for field in kind.fields}
    return {
        "title": kind.__name__,
        "description": " ".join((kind.__doc__ or "").split()),
        "type": "object",
        "properties": {"command": {"const": kind.tag}, **fields},
        "required": ["command", *(field for field in kind.fields if field not in kind.field_defaults)],
        "additionalProperties": False,
    }

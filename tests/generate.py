"""Writes the files that are made from others: `python -m tests.generate`. A test says when one is stale."""

from __future__ import annotations

import json
import runpy
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from btlang.run.events import LOGGED, Event
from btlang.run.field_types import field_type
from btlang.run.json_log import described
from btlang.task import command_schema
from tests.cli_page import cli_page

ROOT = Path(__file__).parent.parent
_TYPES = {"string": "string", "integer": "number", "number": "number", "boolean": "boolean", "null": "null"}


def log_schema() -> dict[str, Any]:
    """The JSON schema (draft 2020-12) of a line of a log, made from the classes of events."""
    common = {name: field_type(Event.__annotations__[name])[1] for name in Event.fields}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "An event of a run of btlang",
        "type": "object",
        "properties": common,
        "required": list(common),
        "oneOf": [described(kind) for kind in LOGGED],
    }


def events_schema() -> str:
    """The same as text, with a line for each class of events."""
    schema = log_schema()
    kinds = ",\n".join(f"  {json.dumps(kind)}" for kind in schema.pop("oneOf"))
    return json.dumps(schema, indent=1).removesuffix("\n}") + f',\n "oneOf": [\n{kinds}\n ]\n}}\n'


def commands_schema() -> str:
    """The JSON schema of commands."""
    return json.dumps(command_schema.schema(), indent=2) + "\n"


def events_module() -> str:
    """The TypeScript types of events, the defaults of their fields, and which of them say that something is wrong."""
    kinds = [kind for kind in LOGGED if kind.tag]
    common = " ".join(_fields(log_schema()))
    each = "\n".join(f"  | {{ {' '.join(_fields(described(kind)))} }} // {kind.__name__}" for kind in kinds)
    defaults = "\n".join(f"  {kind.tag}: {json.dumps(found)}," for kind in kinds if (found := _defaults(kind)))
    alarms = ", ".join(f'"{kind.tag}"' for kind in kinds if kind.alarms)
    return f"""\
// What happens on a robot. Made from btlang/run/events.py by `python -m tests.generate`.

/** Messages leave out fields that have their defaults; see `whole`. */
export type RunEvent = {{ {common} }} & (
{each}
);

/** The defaults of fields by the kinds of events. */
export const DEFAULTS: Partial<Record<string, Record<string, unknown>>> = {{
{defaults}
}};

/** The kinds of events that say that something is wrong. */
export const ALARMS: ReadonlySet<string> = new Set<RunEvent["event"]>([{alarms}]);

/** An event with all its fields, from one without those that have their defaults. */
export function whole(event: {{ event: string }}): RunEvent {{
  return {{ ...DEFAULTS[event.event], ...event }} as RunEvent;
}}
"""


def _fields(described: dict[str, Any]) -> Iterator[str]:
    for name, schema in described["properties"].items():
        is_left_out = name not in described["required"] and "default" not in schema
        yield f"{name}{'?' * is_left_out}: {_type(schema)};"


def _type(schema: dict[str, Any]) -> str:
    if "const" in schema:
        return json.dumps(schema["const"])
    if schema["type"] == "object":
        values = schema.get("additionalProperties")
        return f"Record<string, {_type(values) if values else 'unknown'}>"
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    return " | ".join(_TYPES[kind] for kind in kinds)


def _defaults(kind: type[Event]) -> dict[str, Any]:
    properties = described(kind)["properties"]
    return {name: schema["default"] for name, schema in properties.items() if "default" in schema}


def grammar_tables() -> str:
    """The LALR tables of the grammar."""
    make = runpy.run_path(str(ROOT / "grammar" / "make_tables.py"))
    return str(make["text_of"]((ROOT / "grammar" / "mission.lark").read_text(encoding="utf-8")))


FILES: dict[str, Callable[[], str]] = {
    "btlang/run/events.schema.json": events_schema,
    "btlang/task/commands.schema.json": commands_schema,
    "btlang/web/src/events.ts": events_module,
    "docs/cli.md": cli_page,
    "grammar/mission.tables.json": grammar_tables,
}
"""The files, with what makes the text of each."""


if __name__ == "__main__":
    for name, make in FILES.items():
        (ROOT / name).write_text(make(), encoding="utf-8")

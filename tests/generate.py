"""Writes the files that are made from others: `python -m tests.generate`. A test says when one is stale."""

from __future__ import annotations

import inspect
import json
import keyword
import runpy
import textwrap
from collections.abc import Callable, Iterator
from enum import Enum
from pathlib import Path
from typing import Any

import btlang
from btlang import PUBLIC
from btlang.builders import builder_name
from btlang.run.events import LOGGED, Event
from btlang.run.logs import describe_event
from btlang.support.field_types import field_type
from btlang.task.commands import schema as command_schema
from btlang.tree.catalogue import CATALOGUE, POST_CONDITIONS, PRE_CONDITIONS, NodeKind, Port
from tests.cli_page import cli_page
from tests.reference_pages import codes_page, nodes_page, words_page
from tests.vscode_grammar import grammar

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
        "oneOf": [describe_event(kind) for kind in LOGGED],
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
    each = "\n".join(f"  | {{ {' '.join(_fields(describe_event(kind)))} }} // {kind.__name__}" for kind in kinds)
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
    properties = describe_event(kind)["properties"]
    return {name: schema["default"] for name, schema in properties.items() if "default" in schema}


def grammar_tables() -> str:
    """The LALR tables of the grammar."""
    make = runpy.run_path(str(ROOT / "grammar" / "make_tables.py"))
    return str(make["text_of"]((ROOT / "grammar" / "mission.lark").read_text(encoding="utf-8")))


_PYTHON = {"int": "int | str", "unsigned int": "int | str", "double": "float | str", "bool": "bool | str"}


def builders_stub() -> str:
    """The types of the functions that build trees, for mypy and editors."""
    scripts = "\n".join(f"    {script}: str" for script in (*PRE_CONDITIONS, *POST_CONDITIONS))
    made = [_builder(kind) for kind in CATALOGUE.values()]
    return f"""\
# Made from the catalogue by `python -m tests.generate`.
from typing import TypedDict, Unpack

from btlang.behavior import Behavior, Child, Value
from btlang.behavior import leaf as leaf

class Scripts(TypedDict, total=False):
    \"\"\"Scripts that every node may have.\"\"\"

{scripts}

__all__: list[str]

def builder_name(node_id: str) -> str: ...
""" + "".join(made).lstrip()


def _builder(kind: NodeKind) -> str:
    if kind.roles:
        roles = [_parameter(role) for role in kind.roles]
        children = [f"{role}: Child{' | None = None' * (at >= kind.least)}" for at, role in enumerate(roles)]
    elif kind.most == 1:
        children = ["child: Child"]
    elif kind.most:
        children = ["*children: Child"]
    else:
        children = []
    ports = [f"{_parameter(port)}: {_annotation(found)}" for port, found in kind.ports.items()]
    star = ["*"] if not children or children[0][0] != "*" else []
    others = "**scripts: Value" if kind.any_ports else "**scripts: Unpack[Scripts]"
    parameters = [*children, *star, *ports, 'name: str = ""', others]
    head = _wrapped(f"def {builder_name(kind.id)}(", parameters, ") -> Behavior:", "")
    about = f"Make the node {kind.id} of {kind.origin}."
    text = textwrap.fill(f"{about} {kind.text}".strip(), 112, subsequent_indent="    ")
    end = "\n    " if "\n" in text else ""
    return f'\n{head}\n    """{text}{end}"""\n'


def _parameter(name: str) -> str:
    return f"{name}_" if keyword.iskeyword(name) else name


def _annotation(port: Port) -> str:
    kind = _PYTHON.get(port.type, "Value")
    return kind if port.default is None else f"{kind} | None = None"


def _wrapped(begin: str, items: list[str], end: str, indent: str) -> str:
    """As ruff lays it out: in one line, in one line of its own, or one line each."""
    line = begin + ", ".join(items) + end
    inner = f"{indent}    {', '.join(items)}"
    if len(line) <= 120:
        return line
    if len(inner) <= 120:
        return f"{begin}\n{inner}\n{indent}{end}"
    return "\n".join([begin, *(f"{indent}    {item}," for item in items), f"{indent}{end}"])


def public_stub() -> str:
    """The types of the public names, for mypy and editors."""
    lines = [f"from {module} import {name} as {name}" for module, names in sorted(PUBLIC.items()) for name in names]
    head = "# Made from btlang/__init__.py by `python -m tests.generate`."
    return "\n".join(
        [head, *lines, "", "PUBLIC: dict[str, tuple[str, ...]]", "__all__: list[str]", "__version__: str", ""]
    )


def api_page() -> str:
    """The page about the public names, from their docstrings."""
    parts = [
        "# API reference",
        "Made from the docstrings by `python -m tests.generate`. [library.md](library.md) explains the library with "
        "examples.",
    ]
    for module, names in PUBLIC.items():
        for name in names if module not in ("btlang.builders", "btlang.slots") else ():
            parts += _described(name, getattr(btlang, name))
    rows = [f"| `{name}{_signature(getattr(btlang, name))}` |" for name in PUBLIC["btlang.builders"]]
    slots = ", ".join(f"`{name}`" for name in PUBLIC["btlang.slots"])
    about = "Functions that build trees. The keyword arguments are the ports of the node; engine.md says what it does."
    parts += ["## Builders", about, "\n".join(["| function |", "|---|", *rows])]
    parts += ["## Types of slots", f"For annotations of functions that are words: {slots}."]
    return "\n\n".join(parts) + "\n"


def _described(name: str, found: Any) -> Iterator[str]:
    yield f"## {name}"
    if not inspect.isclass(found):
        yield f"`{name}{_signature(found)}`"
    elif not issubclass(found, Enum | Exception | str):
        fields = getattr(found, "fields", None)
        yield f"`{name}({', '.join(fields) if fields else _signature(found)[1:-1]})`"
    yield inspect.getdoc(found) or ""
    if not inspect.isclass(found):
        return
    for own, member in vars(found).items():
        if own.startswith("_") or not (inspect.isfunction(member) or isinstance(member, property)):
            continue
        text = inspect.getdoc(member)
        if text:
            yield f"### `{name}.{own}{'' if isinstance(member, property) else _signature(member)}`"
            yield text


def _signature(found: Any) -> str:
    """The parameters with their defaults, without types, which editors show."""
    shown = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for name, parameter in inspect.signature(found).parameters.items()
        if name != "self"
    ]
    return str(inspect.Signature(shown))


FILES: dict[str, Callable[[], str]] = {
    "btlang/__init__.pyi": public_stub,
    "btlang/builders.pyi": builders_stub,
    "btlang/run/events.schema.json": events_schema,
    "btlang/task/commands.schema.json": commands_schema,
    "btlang/web/src/events.ts": events_module,
    "docs/cli.md": cli_page,
    "docs/api.md": api_page,
    "docs/codes.md": codes_page,
    "docs/nodes.md": nodes_page,
    "docs/words.md": words_page,
    "editors/vscode/syntaxes/btlang.tmLanguage.json": grammar,
    "grammar/mission.tables.json": grammar_tables,
}
"""The files, with what makes the text of each."""


if __name__ == "__main__":
    for name, make in FILES.items():
        (ROOT / name).write_text(make(), encoding="utf-8")

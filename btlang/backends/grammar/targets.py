"""Targets of grammars: GBNF and EBNF of missions, and a JSON Schema of trees, with the words of a vocabulary.

The schema is that of all trees, with nodes that can run.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator

from btlang.backends.grammar.rules import to_ebnf, to_gbnf
from btlang.backends.grammar.vocabulary_rules import grammar_of
from btlang.backends.json_tree import SCHEMA
from btlang.tree.catalogue import CATALOGUE, MOST_NODES, NodeKind, Port
from btlang.vocabulary.entry import MEASURED, Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Slot, forms
from btlang.vocabulary.value_type import ValueType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_REFERENCE = r"\{[^{}]+\}"  # to an entry of the blackboard
_NUMBER = r"-?[0-9]+(\.[0-9]+)?(e-?[0-9]+)?"
_PATTERNS = {"time": r"([01][0-9]|2[0-3]):[0-5][0-9]"}
_NUMBERS = {"int": r"-?[0-9]+", "unsigned int": "[0-9]+", "double": _NUMBER, "bool": "true|false"}
_TEXTS = ("phrase", "sentence", "place")  # what a tree says about its text


def to_schema(vocabulary: Lexicon) -> str:
    """Return a schema. What fits it fits `tree.schema.json`, and has only known ids, ports and names of places, people
    and objects.

    A schema can't say that the numbers of children make a tree: `btc check` does.
    """
    with open(SCHEMA, encoding="utf-8") as file:
        schema: dict[str, Any] = json.load(file)
    general = schema["$defs"]["node"]
    own = {key: part for key, part in general["properties"].items() if key not in (*_TEXTS, "id", "ports", "children")}
    entries = [entries[0] for entries in vocabulary.entries.values()]
    kinds = [kind for kind in CATALOGUE.values() if kind.id not in vocabulary.entries]
    schema["$id"] = "urn:btlang:mission:1"
    schema["title"] = "A behavior tree of btlang with the words of a vocabulary"
    schema["description"] = "btc check and btc run read documents of this form."
    schema["properties"]["models"] = {"const": []}
    schema["$defs"] = {
        "tree": schema["$defs"]["tree"],
        "node": {
            "anyOf": [
                *(_leaf(entry, vocabulary, own) for entry in entries),
                *(_built_in(kind, general["properties"]["children"], own) for kind in kinds),
            ]
        },
        **{f"value-{kind.name}": _value(kind, vocabulary) for kind in vocabulary.types.values()},
    }
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def _node(node_id: str, ports: dict[str, Any], needed: list[str], own: dict[str, Any], about: str) -> dict[str, Any]:
    """Return an object of a node with this id and these ports, some of them needed."""
    taken = {
        "type": "object",
        "properties": ports,
        "patternProperties": {"^_": {"type": "string"}},  # pre- and postconditions
        "additionalProperties": False,
        **({"required": needed} if needed else {}),
    }
    return {
        **({"description": about} if about else {}),
        "type": "object",
        "properties": {"id": {"const": node_id}, **own, "ports": taken},
        "required": ["id", "ports"] if needed else ["id"],
        "additionalProperties": False,
    }


def _leaf(entry: Entry, vocabulary: Lexicon, own: dict[str, Any]) -> dict[str, Any]:
    ports = {slot.name: {"$ref": f"#/$defs/value-{slot.type}"} for slot in entry.slots}
    if entry.measures:
        ports[MEASURED] = {"type": "string", "pattern": f"^{_REFERENCE}$"}
    said = [{part for part in form if isinstance(part, Slot)} for text in entry.phrases for form in forms(text)]
    always = set.intersection(*said) if said else set()
    needed = [slot.name for slot in entry.slots if slot.default is None and Slot(slot.name) in always]
    return _node(entry.id, ports, needed, own, " ".join(entry.help.split()))


def _built_in(kind: NodeKind, children: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    ports = {name: _port(port) for name, port in kind.ports.items()}
    needed = [name for name, port in kind.ports.items() if port.default is None]
    node = _node(kind.id, ports, needed, own, kind.text)
    if kind.any_ports:
        node["properties"]["ports"]["additionalProperties"] = {"type": "string"}
    if kind.most:
        most = {} if kind.most == MOST_NODES else {"maxItems": kind.most}
        node["properties"]["children"] = {**children, "minItems": kind.least, **most}
        node["required"].append("children")
    return node


def _port(port: Port) -> dict[str, str]:
    pattern = _NUMBERS.get(port.type) or (_PATTERNS["time"] if port.unit == "time of day" else "")
    return {"type": "string", **({"pattern": f"^({pattern}|{_REFERENCE})$"} if pattern else {})}


def _value(kind: ValueType, vocabulary: Lexicon) -> dict[str, Any]:
    """Return the text of a port of the type."""
    if kind.kind == "text":
        return {"type": "string"}
    about = "".join(_unit(kind))
    described = {"description": about} if about else {}
    if kind.kind == "names":
        reference = {"pattern": f"^{_REFERENCE}$"}
        return {**described, "type": "string", "anyOf": [{"enum": vocabulary.values.names(kind.name)}, reference]}
    pattern = _PATTERNS.get(kind.kind) or (r"[1-9][0-9]*" if kind.whole else _NUMBER)
    if kind.least is not None:
        pattern = pattern.removeprefix("-?")
    return {**described, "type": "string", "pattern": f"^({pattern}|{_REFERENCE})$"}


def _unit(kind: ValueType) -> Iterator[str]:
    if kind.units:
        yield f"in {kind.units[0].words[0]}"


GRAMMARS: dict[str, Callable[[Lexicon], str]] = {
    "gbnf": lambda vocabulary: to_gbnf(grammar_of(vocabulary)),
    "ebnf": lambda vocabulary: to_ebnf(grammar_of(vocabulary)),
    "json-schema": to_schema,
}
"""Each makes the text for a vocabulary: missions for llama.cpp, missions in the EBNF of the W3C, trees as JSON."""

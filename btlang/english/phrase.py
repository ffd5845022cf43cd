"""A leaf as its phrase, in the first words that its keyword entry offers."""

from __future__ import annotations

from btlang.tree.dump import described
from btlang.tree.node import Node
from btlang.vocabulary.pattern import Form, Slot, forms
from btlang.vocabulary.values import ValueType
from btlang.vocabulary.vocabulary import Vocabulary


def phrase_of(node: Node, vocabulary: Vocabulary) -> str:
    """The English of a node: `move forward 2 m`, `wait 5 s`, the name of a subtree; else `Id port=value`."""
    if node.id == "SubTree":
        return node.port("ID")
    if node.id == "Sleep":
        return f"{vocabulary.word('wait')} {seconds(node.port('msec'))}"
    if node.id in ("AlwaysSuccess", "AlwaysFailure"):
        return vocabulary.word("nothing" if node.id == "AlwaysSuccess" else "fail")
    ports = dict(node.ports)
    for entry in vocabulary.entries.get(node.id, ()):
        for phrase in entry.phrases:
            fitting = [form for form in forms(phrase) if {p.name for p in form if isinstance(p, Slot)} == ports.keys()]
            if fitting:
                types = {slot.name: vocabulary.types[slot.type] for slot in entry.slots}
                return _filled(fitting[-1], ports, types)
    return described(node)


def seconds(msec: str) -> str:
    """Milliseconds of a port as seconds."""
    return f"{int(msec) / 1000:g} s" if msec.isdigit() else msec


def _filled(form: Form, ports: dict[str, str], types: dict[str, ValueType]) -> str:
    words = [value_of(ports[part.name], types[part.name]) if isinstance(part, Slot) else part for part in form]
    return " ".join(words)


def value_of(text: str, kind: ValueType) -> str:
    """A port text as a user would say it: `2 m`, `20%`, `"two words"`."""
    if kind.kind == "quantity":
        unit = kind.units[0].words[0]
        return f"{text}{unit}" if unit in ("%", "°") else f"{text} {unit}"
    return f'"{text}"' if kind.kind == "text" and not text.isalnum() else text

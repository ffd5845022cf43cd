"""The types of slots that are drafted for the ports of a node: from their types in C++, and from how trees use them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping

from btlang.tree.model import PortModel
from btlang.tree.node import Node
from btlang.vocabulary.value_type import TEXT, ValueType, format_number

_WHOLE = re.compile(r"(?:std::)?(?:u?int(?:8|16|32|64)?(?:_t)?|unsigned(?: int)?|size_t|u?long)")
_DECIMAL = re.compile(r"float|double|(?:std::)?float(?:32|64)_t")
_CHOICE = re.compile(r"\w+(?:\|\w+)+")
NUMBER = "number"
_BOOLEANS = ValueType("boolean", "names", names=("true", "false"))
_WHOLE_NUMBERS = ValueType("whole_number", NUMBER, whole=True)


class SlotTypes:
    """Types that a keyword file needs beside those that are `known`; each has a name of its own."""

    def __init__(self, known: Mapping[str, ValueType]) -> None:
        self._known = known
        self._own: dict[str, ValueType] = {}

    def of(self, node_id: str, port: PortModel, uses: Iterable[Node]) -> ValueType:
        """The type of a slot. It is text wherever a tree has a text that another type would not give back as it is."""
        texts = [text for node in uses for name, text in node.ports if name == port.name and "{" not in text]
        if port.direction != "output":
            names = _choices(port)
            if port.type == "bool" and set(texts) <= set(_BOOLEANS.names):
                return self._named(_BOOLEANS, node_id)
            if names and set(texts) <= set(names):
                return self._named(ValueType(port.name, "names", names=names), node_id)
            if _WHOLE.fullmatch(port.type) and all(map(_is_whole, texts)):
                return self._named(_WHOLE_NUMBERS, node_id)
            if (_DECIMAL.fullmatch(port.type) or (not port.type and texts)) and all(map(_is_number, texts)):
                return self._known[NUMBER]
        return self._known[TEXT]

    def _named(self, type: ValueType, node_id: str) -> ValueType:
        """The type under its name, or under one with that of the node where something else has it."""
        for name in (type.name, f"{node_id}_{type.name}"):
            made: ValueType = type.replace(name=name)
            if self._known.get(name, made) == made and self._own.setdefault(name, made) == made:
                return made
        return self._known[TEXT]


def _choices(port: PortModel) -> tuple[str, ...]:
    """The values of a port whose type or description lists them: `top|side|front`."""
    found = _CHOICE.fullmatch(port.type) or _CHOICE.search(port.text)
    return tuple(dict.fromkeys(found[0].split("|"))) if found else ()


def _is_number(text: str) -> bool:
    return _reads_as(text, float)


def _is_whole(text: str) -> bool:
    return _reads_as(text, int)


def _reads_as(text: str, number: Callable[[str], float]) -> bool:
    try:
        return text.isascii() and format_number(number(text)) == text and "e" not in text
    except (ValueError, OverflowError):
        return False

"""Types of values, and how numbers are written."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.support.record import Record
from btlang.text.source import Span

TEXT = "text"
PLACE = "place"
"""The type whose values can be points, too."""
OBJECT = "object"
DOOR = "door"
PERSON = "person"
ZONE = "zone"
KINDS = "kinds"
"""A kind of what a world has, in the plural: `cups`."""
WORLD = (PLACE, PERSON, OBJECT, ZONE, DOOR)
"""The types of names that have a place: robots know where each one is."""


class Unit(Record):
    """`numerator / denominator` of the base unit; the first word is the one printed."""

    words: tuple[str, ...]
    numerator: float
    denominator: float


def with_unit(number: str, unit: str) -> str:
    """A number and a word of a unit as they are written: `2 m`, `20%`."""
    return f"{number} {unit}" if unit[0].isalpha() else number + unit


class ValueType(Record, uncompared=("span",)):
    """A type that a slot may have, and where a keyword file declares it.

    `kind` is "quantity" (a number with one of `units`), "number" (no unit), "text", "time" (of day) or "names" (one of
    a list).
    """

    name: str
    kind: str
    units: tuple[Unit, ...] = ()
    whole: bool = False
    least: float | None = None
    names: tuple[str, ...] = ()
    span: Span | None = None

    @property
    def example(self) -> str:
        """A value as a user would write it."""
        if self.kind == "quantity":
            return with_unit("5", self.units[0].words[0])
        if self.kind == "names":
            return self.names[0] if self.names else self.name
        return {"text": '"hello"', "time": "6 pm"}.get(self.kind, "3")


def number_type(types: Mapping[str, ValueType]) -> str:
    """The type of plain numbers."""
    return next(kind for kind, one in types.items() if one.kind == "number" and not one.whole)


def format_number(value: float) -> str:
    """The shortest text that reads back as the number: 2, 0.5, 1e-07."""
    whole = int(value)
    return str(whole) if whole == value and abs(value) < 1e15 else repr(value)

"""A keyword entry with a `ros` table, and messages for interfaces and fields that ROS 2 lacks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.engine.leaves.leaf import ActionFailed
from btlang.ros.messages import type_name
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest
from btlang.vocabulary.ros_table import SLOT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon
    from btlang.vocabulary.ros_binding import RosBinding
    from btlang.vocabulary.value_type import ValueType

    Locate: TypeAlias = Callable[[str], tuple[float, float, float | None]]

_SI = {"angle": math.pi / 180, "percent": 0.01}
"""Factors from values of these types to those in messages; all others are SI as they are."""


class RosWord:
    """A keyword entry, the types of its slots, and its places.

    `locate` returns x and y in metres and the direction to face in radians, None for any, in the frame `map`; it raises
    KeyError for an unknown place.
    """

    def __init__(self, entry: Entry, vocabulary: Lexicon, locate: Locate) -> None:
        assert entry.ros is not None
        self.entry = entry
        self.ros: RosBinding = entry.ros
        self.types: dict[str, ValueType] = {slot.name: vocabulary.types[slot.type] for slot in entry.slots}
        self.measured: ValueType | None = vocabulary.types.get(entry.measures)
        self._locate = locate

    @property
    def phrase(self) -> str:
        """The first phrase of the entry."""
        return (*self.entry.phrases, *self.entry.quantity, self.entry.id)[0]

    def interface(self, name: str = "") -> Any:
        """Return the class of a type, by default that of the table. Raises MissionError (BT104)."""
        name = name or self.ros.interface
        package, _, rest = name.partition("/")
        module, _, cls = rest.partition("/")
        try:
            found = import_module(f"{package}.{module}")
        except ImportError:
            advice = f"Install the package {package}, or source the workspace that contains it."
            raise self.problem("BT104", name, type=name, advice=advice) from None
        if not hasattr(found, cls):
            known = [other for other in dir(found) if other[0].isupper()]
            raise self.problem("BT104", name, type=name, advice=_suggestion(cls, known))
        return getattr(found, cls)

    def no_field(self, cls: Any, field: str, path: str, known: Iterable[str]) -> MissionError:
        """Return the error that a message has no such field (BT105)."""
        return self.problem("BT105", path, type=type_name(cls), field=field, advice=_suggestion(field, known))

    def misfit(self, cls: Any, near: str, reason: str) -> MissionError:
        """Return the error that a value doesn't fit a field (BT106)."""
        return self.problem("BT106", near, type=type_name(cls), reason=reason)

    def problem(self, code: str, near: str, **texts: str) -> MissionError:
        """Return an error at the text in the table, if there is one."""
        span = self.entry.span or Span(Source("", self.entry.file), 0, 0)
        start = span.source.text.find(near, span.end)
        place = Span(span.source, start, start + len(near)) if near and start >= 0 else span
        return MissionError([diagnostic(code, place, (), None, phrase=self.phrase, **texts)])

    def factor(self, slot: str, unit: str = "") -> float:
        """Return the factor from the value of a slot to SI, or to a unit. Raises LookupError."""
        kind = self.types[slot]
        if not unit:
            return _SI.get(kind.name, 1.0)
        for other in kind.units:
            if unit in other.words:
                return other.denominator / other.numerator
        raise LookupError(f"'{unit}' isn't a unit of the type {kind.name}")

    @property
    def scale(self) -> float:
        """The factor from the value in a message to the quantity."""
        given = self.ros.get("scale")
        return float(given) if given is not None else 1 / _SI.get(self.measured.name if self.measured else "", 1.0)

    def amount(self, key: str, default: float) -> Callable[[Mapping[str, Any]], float]:
        """Return a function from the values of slots to an amount of the table, in SI."""
        given = self.ros.get(key, default)
        slot = SLOT.fullmatch(given) if isinstance(given, str) else None
        if slot is None:
            return lambda values: float(given)
        name, unit = slot.groups()
        try:
            factor = self.factor(name, unit or "")
        except LookupError as error:
            raise self.misfit(self.ros.interface, given, str(error)) from None
        return lambda values: float(values[name]) * factor if name in values else default

    def located(self, name: str) -> tuple[float, float, float | None]:
        """Return where a place is. Raises ActionFailed."""
        try:
            return self._locate(name)
        except KeyError:
            raise ActionFailed(f"I don't know where {name} is") from None


def _suggestion(written: str, known: Iterable[str]) -> str:
    known = list(known)
    near = nearest(written.lower(), known)
    if near:
        return f"Similar: {', '.join(near)}"
    return f"It has {', '.join(known)}." if len(known) <= 12 else ""

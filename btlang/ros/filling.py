"""Messages filled with the values of slots: the tables of fields in keyword files, made ready once for each leaf."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.engine.leaves.leaf import ActionFailed
from btlang.ros.fields import INTEGERS, array_of, field_types, inner_class, message_class
from btlang.ros.poses import MAP, set_yaw
from btlang.ros.times import duration
from btlang.ros.word import Word, type_name
from btlang.vocabulary.ros_binding import Fields
from btlang.vocabulary.ros_table import SLOT, slots_of
from btlang.vocabulary.value_type import format_number

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.vocabulary.ros_binding import Value

    Values: TypeAlias = Mapping[str, Any]
    Make: TypeAlias = Callable[[Values], Any]
    Now: TypeAlias = Callable[[], Any]

NOW = "now"
"""What a field of the type builtin_interfaces/Time may be given."""
_POINTS = ("Point", "Point32", "Pose", "PoseStamped", "Pose2D")


def filler(word: Word, cls: Any, fields: Fields | None, now: Now) -> Make:
    """A function that makes a message of the values of the slots; what a mission left out stays as the message has it.

    `now` gives the time as a message. Raises MissionError (BT104 to BT106); the function raises ActionFailed where a
    value does not fit.
    """
    steps = [_step(word, cls, path, value, now) for path, value in (fields.given if fields else ())]

    def make(values: Values) -> Any:
        message = cls()
        for parents, name, used, value_of in steps:
            if used <= values.keys():
                at = message
                for parent in parents:
                    at = getattr(at, parent)
                value = value_of(values)
                if callable(value):
                    value(getattr(at, name))
                    continue
                try:
                    setattr(at, name, value)
                except (AssertionError, OverflowError, ValueError, TypeError):
                    raise ActionFailed(f"{value!r} does not fit {name} of {type_name(cls)}") from None
        return message

    return make


def _step(word: Word, cls: Any, path: str, value: Value, now: Now) -> tuple[list[str], str, set[str], Make]:
    *parents, name = path.split(".")
    owner = cls
    for at, part in enumerate([*parents, name]):
        types = field_types(owner)
        if part not in types:
            raise word.no_field(owner, part, path, types)
        kind = types[part]
        if at < len(parents):
            owner = inner_class(word, owner, part, kind, path)
    return parents, name, set(slots_of(value)), _maker(word, owner, name, kind, value, now)


def _maker(word: Word, owner: Any, name: str, kind: str, value: Value, now: Now) -> Make:
    """A function that gives the value of a field of a type; or what puts a place into the message that is there."""

    def misfit(reason: str = "") -> Exception:
        shown = (
            f'"{value}"' if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else str(value)
        )
        return word.misfit(owner, name, reason or f"{name} is {kind}, which cannot hold {shown}")

    array = array_of(kind)
    if array is not None:
        element, length = array
        if not isinstance(value, tuple):
            raise misfit(f"{name} is an array, so give a list")
        if length is not None and len(value) != length:
            raise misfit(f"{name} has {length} values, not {len(value)}")
        makers = [_maker(word, owner, name, element, item, now) for item in value]
        return lambda values: [_element(word, element, make(values)) for make in makers]
    if isinstance(value, Fields):
        if "/" not in kind:
            raise misfit()
        return filler(word, message_class(word, kind), value, now)
    slot = SLOT.fullmatch(value) if isinstance(value, str) else None
    if slot is not None:
        try:
            return _slot(word, slot[1], slot[2] or "", kind, name)
        except LookupError as error:
            raise misfit(str(error)) from None
    if kind == "builtin_interfaces/Time" and value == NOW:
        return lambda values: now()
    if kind == "builtin_interfaces/Duration" and isinstance(value, int | float) and not isinstance(value, bool):
        return lambda values: duration(float(value))
    if kind.startswith(("string", "wstring")):
        if not isinstance(value, str):
            raise misfit()
        return lambda values: SLOT.sub(lambda found: _text(word, values, found[1], found[2] or ""), value)
    constant = getattr(owner, value, None) if isinstance(value, str) and value.isidentifier() else value
    try:
        fitted = _fitted(constant, kind)
    except ValueError:
        raise misfit() from None
    return lambda values: fitted


def _element(word: Word, kind: str, value: Any) -> Any:
    """An element of an array; a place is written into a new message."""
    if not callable(value):
        return value
    message = message_class(word, kind)()
    value(message)
    return message


def _fitted(value: Any, kind: str) -> Any:
    """A constant as Python has it for a type of field. Raises ValueError."""
    if kind == "boolean" and isinstance(value, bool):
        return value
    if kind in ("float", "double") and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if kind in INTEGERS and isinstance(value, int) and not isinstance(value, bool):
        least, most = INTEGERS[kind]
        if least <= value <= most:
            return value
    raise ValueError(kind)


def _slot(word: Word, slot: str, unit: str, kind: str, name: str) -> Make:
    """Raises LookupError where a slot cannot fill a field of the type."""
    sort = word.types[slot].kind
    if sort in ("quantity", "number"):
        factor = word.factor(slot, unit)
        if kind == "builtin_interfaces/Duration":
            return lambda values: duration(float(values[slot]))
        if kind in ("float", "double"):
            return lambda values: float(values[slot]) * factor
        if kind in INTEGERS:
            return lambda values: _whole(float(values[slot]) * factor, kind, name)
    elif kind.partition("/")[2] in _POINTS:
        return lambda values: _placed(kind.partition("/")[2], word.located(str(values[slot])))
    if kind.startswith(("string", "wstring")):
        return lambda values: _text(word, values, slot, unit)
    raise LookupError(f"{name} is {kind}, which the slot {{{slot}}} of the type {word.types[slot].name} cannot fill")


def _text(word: Word, values: Values, slot: str, unit: str) -> str:
    value = values[slot]
    return value if isinstance(value, str) else format_number(value * (word.factor(slot, unit) if unit else 1))


def _whole(value: float, kind: str, name: str) -> int:
    least, most = INTEGERS[kind]
    if not least <= value <= most:
        raise ActionFailed(f"{value:g} does not fit {name}, which goes from {least} to {most}")
    return round(value)


def _placed(kind: str, pose: tuple[float, float, float | None]) -> Callable[[Any], None]:
    """What writes a place into a message, and leaves what else is in it."""
    x, y, facing = pose

    def write(message: Any) -> None:
        if kind == "PoseStamped":
            message.header.frame_id = message.header.frame_id or MAP
            message = message.pose
        if kind in ("Pose", "PoseStamped"):
            set_yaw(message.orientation, facing or 0.0)
            message = message.position
        message.x, message.y = x, y
        if kind == "Pose2D":
            message.theta = facing or 0.0

    return write

"""Fields of messages: their types, values read by a path, and messages filled with the values of slots."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

from btlang.engine.leaves.leaf import ActionFailed
from btlang.ros.messages import MAP, duration, echoes, seconds_of, set_yaw, type_name
from btlang.ros.words.word import RosWord
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

INTEGERS = {
    f"{sign}int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
"""The types of whole numbers, with the least and the most that they hold."""
_TIMES = ("builtin_interfaces/Duration", "builtin_interfaces/Time")
_REDUCERS: dict[str, Callable[[list[Any]], Any]] = {
    "min": min, "max": max, "sum": sum, "any": any, "all": all, "mean": lambda values: sum(values) / len(values)
}  # fmt: skip
NOW = "now"
"""The value for a field of type builtin_interfaces/Time."""
_POINTS = ("Point", "Point32", "Pose", "PoseStamped", "Pose2D")


def field_types(cls: Any) -> dict[str, str]:
    """Return the type of each field of a message class: `double`, `sequence<string>`, `geometry_msgs/Pose`."""
    return dict(cls.get_fields_and_field_types())


def array_of(kind: str) -> tuple[str, int | None] | None:
    """Return the element type of an array, and its length if that is fixed; None for any other type."""
    sequence = re.fullmatch(r"sequence<(.+?)(?:, (\d+))?>", kind)
    if sequence:
        return sequence[1], None
    fixed = re.fullmatch(r"(.+)\[(\d+)\]", kind)
    return (fixed[1], int(fixed[2])) if fixed else None


def message_class(word: RosWord, kind: str) -> Any:
    """Return the class of a field that is a message."""
    package, _, name = kind.partition("/")
    return word.interface(f"{package}/msg/{name}")


def inner_class(word: RosWord, owner: Any, name: str, kind: str, path: str) -> Any:
    """Return the class of a field that a path goes into."""
    if "/" not in kind or array_of(kind) is not None:
        raise word.misfit(owner, path, f"{name} is {kind}, which has no fields of its own")
    return message_class(word, kind)


def make_reader(word: RosWord, cls: Any) -> Callable[[Any], Any]:
    """Return a function that reads the value that a word's table names in a message.

    Raises MissionError (BT104 to BT106). The function raises ValueError if a message has no such value.
    """
    path = word.ros.get("field", "")
    steps: list[tuple[str, int | None]] = []
    kind, owner = "", cls
    for part in path.split("."):
        if steps:
            owner = inner_class(word, owner, steps[-1][0], kind, path)
        name, index = _part(part)
        types = field_types(owner)
        if name not in types:
            raise word.no_field(owner, name, path, types)
        kind = types[name]
        if index is not None:
            array = array_of(kind)
            if array is None:
                raise word.misfit(owner, path, f"{name} is {kind}, which has no elements")
            kind = array[0]
        steps.append((name, index))

    def follow(message: Any) -> Any:
        for name, index in steps:
            message = getattr(message, name)
            if index is not None:
                if index >= len(message):
                    raise ValueError(f"{path} is not there: {name} has {len(message)} elements")
                message = message[index]
        return message

    if kind in _TIMES:
        return lambda message: seconds_of(follow(message))
    array = array_of(kind)
    if "/" in kind:
        raise word.misfit(cls, path, f"{path} is {kind}: name one of its fields")
    reduce = word.ros.get("reduce")
    if (array is None) != (reduce is None):
        reason = f"{path} is {kind}, so " + ("reduce doesn't apply" if array is None else 'reduce = "min" is needed')
        raise word.misfit(cls, path, reason)
    return follow if array is None else _make_reducer(word, cls, path, follow, _REDUCERS[reduce])


def _part(part: str) -> tuple[str, int | None]:
    found = re.fullmatch(r"(\w+)\[(\d+)\]", part)
    return (found[1], int(found[2])) if found else (part, None)


def _make_reducer(
    word: RosWord, cls: Any, path: str, follow: Callable[[Any], Any], reduce: Callable[[list[Any]], Any]
) -> Callable[[Any], Any]:
    """Return a function that reduces an array, or part of it by indexes or by angles of a scan, to one value."""
    indexes, degrees = word.ros.get("indexes"), word.ros.get("degrees")
    missing = {"angle_min", "angle_increment"} - field_types(cls).keys()
    if degrees is not None and missing:
        raise word.misfit(cls, "degrees", "degrees is for messages with angle_min and angle_increment")
    scan = {"range_min", "range_max"} <= field_types(cls).keys() and path == "ranges"

    def read(message: Any) -> Any:
        values = echoes(message).tolist() if scan else list(follow(message))
        if indexes is not None:
            values = values[int(indexes[0]) : int(indexes[1]) + 1]
        if degrees is not None:
            values = [v for at, v in enumerate(values) if _within(message, at, *degrees)]
        valid = [v for v in values if v == v]
        if not valid:
            raise ValueError(f"{path} has no value there")
        return reduce(valid)

    return read


def _within(scan: Any, at: int, low: float, high: float) -> bool:
    angle = math.degrees(scan.angle_min + at * scan.angle_increment)
    return (angle - low) % 360 <= (high - low) + 1e-6


def make_filler(word: RosWord, cls: Any, fields: Fields | None, now: Now) -> Make:
    """Return a function that makes a message from the values of slots; what a mission leaves out keeps its default.

    `now` gives the time as a message. Raises MissionError (BT104 to BT106); the function raises ActionFailed if a value
    doesn't fit.
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


def _step(word: RosWord, cls: Any, path: str, value: Value, now: Now) -> tuple[list[str], str, set[str], Make]:
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


def _maker(word: RosWord, owner: Any, name: str, kind: str, value: Value, now: Now) -> Make:
    """Return a function for the value of a field of a type; or one that writes a place into the existing message."""

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
        return make_filler(word, message_class(word, kind), value, now)
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
        fitted = _fit_constant(constant, kind)
    except ValueError:
        raise misfit() from None
    return lambda values: fitted


def _element(word: RosWord, kind: str, value: Any) -> Any:
    """Return a function for an element of an array; a place is written into a new message."""
    if not callable(value):
        return value
    message = message_class(word, kind)()
    value(message)
    return message


def _fit_constant(value: Any, kind: str) -> Any:
    """Return a constant as Python has it for a type of field. Raises ValueError."""
    if kind == "boolean" and isinstance(value, bool):
        return value
    if kind in ("float", "double") and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if kind in INTEGERS and isinstance(value, int) and not isinstance(value, bool):
        least, most = INTEGERS[kind]
        if least <= value <= most:
            return value
    raise ValueError(kind)


def _slot(word: RosWord, slot: str, unit: str, kind: str, name: str) -> Make:
    """Return a function for the value of a slot. Raises LookupError if it can't fill a field of the type."""
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
        return lambda values: _make_place_writer(kind.partition("/")[2], word.located(str(values[slot])))
    if kind.startswith(("string", "wstring")):
        return lambda values: _text(word, values, slot, unit)
    raise LookupError(f"{name} is {kind}, which the slot {{{slot}}} of the type {word.types[slot].name} cannot fill")


def _text(word: RosWord, values: Values, slot: str, unit: str) -> str:
    value = values[slot]
    return value if isinstance(value, str) else format_number(value * (word.factor(slot, unit) if unit else 1))


def _whole(value: float, kind: str, name: str) -> int:
    least, most = INTEGERS[kind]
    if not least <= value <= most:
        raise ActionFailed(f"{value:g} does not fit {name}, which goes from {least} to {most}")
    return round(value)


def _make_place_writer(kind: str, pose: tuple[float, float, float | None]) -> Callable[[Any], None]:
    """Return a function that writes a place into a message, and keeps its other fields."""
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

"""Types of message fields as rclpy's classes declare them, and values read by the path of a field."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from btlang.ros.scans import echoes
from btlang.ros.times import seconds_of
from btlang.ros.word import Word

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

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


def field_types(cls: Any) -> dict[str, str]:
    """The type of each field of a message class: `double`, `sequence<string>`, `geometry_msgs/Pose`."""
    return dict(cls.get_fields_and_field_types())


def array_of(kind: str) -> tuple[str, int | None] | None:
    """The type of the elements of an array, and how many it has where that is fixed; None for any other type."""
    sequence = re.fullmatch(r"sequence<(.+?)(?:, (\d+))?>", kind)
    if sequence:
        return sequence[1], None
    fixed = re.fullmatch(r"(.+)\[(\d+)\]", kind)
    return (fixed[1], int(fixed[2])) if fixed else None


def message_class(word: Word, kind: str) -> Any:
    """The class of a field that is a message."""
    package, _, name = kind.partition("/")
    return word.interface(f"{package}/msg/{name}")


def inner_class(word: Word, owner: Any, name: str, kind: str, path: str) -> Any:
    """The class of a field whose own fields a path names."""
    if "/" not in kind or array_of(kind) is not None:
        raise word.misfit(owner, path, f"{name} is {kind}, which has no fields of its own")
    return message_class(word, kind)


def reader(word: Word, cls: Any) -> Callable[[Any], Any]:
    """A function that gives the value that the table of a word names in a message.

    Raises MissionError (BT104 to BT106). The function raises ValueError, in words, where a message has no such value.
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
    return follow if array is None else _reduced(word, cls, path, follow, _REDUCERS[reduce])


def _part(part: str) -> tuple[str, int | None]:
    found = re.fullmatch(r"(\w+)\[(\d+)\]", part)
    return (found[1], int(found[2])) if found else (part, None)


def _reduced(
    word: Word, cls: Any, path: str, follow: Callable[[Any], Any], reduce: Callable[[list[Any]], Any]
) -> Callable[[Any], Any]:
    """One value of those of an array, or of those within indexes, or within angles of a scan."""
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

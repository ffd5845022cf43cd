"""Messages as JSON, as rosbridge writes them (bytes as base64, NaN as null), and the types that clients name."""

from __future__ import annotations

import binascii
import math
import re
from base64 import b64decode, b64encode
from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from pathlib import Path

import numpy as np

from btlang.ros.bridge.replies import BridgeError
from btlang.ros.messages import type_name
from btlang.ros.words.fields import INTEGERS, array_of, field_types
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Write: TypeAlias = Callable[[Any], Any]
    Now: TypeAlias = Callable[[], Any]

_TYPE = re.compile(r"([a-z][a-z0-9_]{0,99})/(?:(msg|srv|action)/)?([A-Z][A-Za-z0-9_]{0,99})")
_FORMS = {"msg": "a type of messages", "srv": "a type of services", "action": "a type of actions"}
_FLOATS, _BYTES = ("float", "double"), ("octet", "uint8")
_HEADER = "std_msgs/Header"


@cache
def type_of(name: str, kind: str) -> Any:
    """Return the class of a type, with or without its kind: std_msgs/msg/String,
    std_msgs/String. Raises BridgeError.
    """
    found = _TYPE.fullmatch(name)
    shown = one_line(name[:100])
    if found is None:
        raise BridgeError(f"'{shown}' isn't a type. Write for example: std_msgs/msg/String.")
    if found[2] not in (None, kind):
        raise BridgeError(f"'{shown}' isn't {_FORMS[kind]}.")
    if not _is_interfaces(found[1]):
        raise BridgeError(f"There's no package of interfaces called '{found[1]}' on this computer.")
    try:
        return getattr(import_module(f"{found[1]}.{kind}"), found[3])
    except (ImportError, AttributeError):
        raise BridgeError(f"There's no type '{found[1]}/{kind}/{found[3]}' on this computer.") from None


def _is_interfaces(package: str) -> bool:
    """Return whether rosidl generated a package. Importing any other package would run its code."""
    spec = PathFinder.find_spec(package)
    folders = (spec.submodule_search_locations or ()) if spec is not None else ()
    return any(any(Path(folder).glob("*__rosidl_typesupport_c*")) for folder in folders)


def as_data(message: Any) -> dict[str, Any]:
    """Return the fields of a message, for JSON."""
    cls: Any = type(message)
    return {name: write(getattr(message, name)) for name, write in _writers(cls)}


@cache
def _writers(cls: Any) -> list[tuple[str, Write]]:
    return [(name, _writer(kind)) for name, kind in field_types(cls).items()]


def _writer(kind: str) -> Write:
    array = array_of(kind)
    element = kind if array is None else array[0]
    if element == "octet":
        return (lambda value: value[0]) if array is None else lambda values: _base64(b"".join(values))
    if element in _FLOATS:
        return _finite if array is None else _all_finite
    if "/" in element:
        return as_data if array is None else lambda values: [as_data(value) for value in values]
    if array is None:
        return lambda value: value
    return _base64 if element == "uint8" else lambda values: np.asarray(values).tolist()


def _base64(values: Any) -> str:
    return b64encode(bytes(values)).decode()


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _all_finite(values: Any) -> list[float | None]:
    numbers = np.asarray(values, dtype=float)
    if np.isfinite(numbers).all():
        return numbers.tolist()  # type: ignore[no-any-return]
    return [_finite(number) for number in numbers.tolist()]


def fill_message(cls: Any, data: object, now: Now) -> Any:
    """Return a message of a class with these fields; other fields keep their defaults.

    A header without a stamp gets that of `now`. Raises BridgeError.
    """
    message = cls()
    if isinstance(data, list):  # the fields of a request in their order
        data = dict(zip(field_types(cls), data, strict=False)) if len(data) <= len(field_types(cls)) else data
    _fill(message, data, "", now)
    return message


def _fill(message: Any, data: object, path: str, now: Now) -> None:
    name = type_name(type(message))
    if not isinstance(data, Mapping):
        raise BridgeError(f"{path or 'The message'} must be an object with the fields of {name}.")
    kinds = field_types(type(message))
    for field, value in data.items():
        if field not in kinds:
            raise BridgeError(f"{name} has no field '{one_line(field[:100])}'. Its fields: {', '.join(kinds)}.")
        place = f"{path}.{field}" if path else field
        try:
            setattr(message, field, _read(kinds[field], value, place, now))
        except (AssertionError, OverflowError, TypeError, ValueError):
            raise BridgeError(f"{place} is {kinds[field]}, which can't hold that value.") from None
    for field, kind in kinds.items():
        given = data.get(field)
        if kind == _HEADER and not (isinstance(given, Mapping) and "stamp" in given):
            getattr(message, field).stamp = now()


def _read(kind: str, value: object, place: str, now: Now) -> Any:
    array = array_of(kind)
    if array is not None:
        return _read_array(array[0], array[1], value, place, now)
    if "/" in kind:
        message = type_of(kind, "msg")()
        _fill(message, value, place, now)
        return message
    if kind == "boolean" and isinstance(value, bool):
        return value
    if kind.startswith(("string", "wstring")) and isinstance(value, str):
        value.encode()  # half a surrogate pair is no text
        return value
    if isinstance(value, int | float) and not isinstance(value, bool):
        if kind in _FLOATS and math.isfinite(value):
            return float(value)
        least, most = INTEGERS.get("uint8" if kind == "octet" else kind, (1, 0))
        if isinstance(value, int) and least <= value <= most:
            return bytes([value]) if kind == "octet" else value
    raise BridgeError(f"{place} is {kind}, which can't hold that value.")


def _read_array(element: str, length: int | None, value: object, place: str, now: Now) -> Any:
    if element in _BYTES and isinstance(value, str):
        try:
            value = list(b64decode(value, validate=True))
        except (binascii.Error, ValueError):
            raise BridgeError(f"{place} isn't base64.") from None
    if not isinstance(value, list):
        raise BridgeError(f"{place} must be a list.")
    if length is not None and len(value) != length:
        raise BridgeError(f"{place} must have {length} values, not {len(value)}.")
    return [_read(element, each, f"{place}[{at}]", now) for at, each in enumerate(value)]

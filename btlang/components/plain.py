"""Values that go from one process to another: as JSON, so that what comes never runs code."""

from __future__ import annotations

import base64
from collections.abc import Mapping

from btlang.devices import kinds
from btlang.devices.kinds import Command, Reading
from btlang.engine.leaves.leaf import ActionFailed, Unknown, reason_of
from btlang.robots.geometry import Pose
from btlang.support.record import Record
from btlang.text.json_text import dump_json, load_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_RECORDS = {
    each.__name__: each
    for each in (Pose, *(each for each in vars(kinds).values() if isinstance(each, type)))
    if issubclass(each, Reading | Command | Pose)
}
_RECORD, _BYTES = "record", "bytes"


def packed(message: object) -> bytes:
    """A message as bytes. Raises TypeError for values that are neither plain data nor a pose, reading or command."""
    try:
        return dump_json(message, _other, separators=(",", ":")).encode()
    except ValueError:
        raise TypeError("a value that is in itself, or nested too deeply, can't be handed to another process") from None


def unpacked(data: bytes) -> Any:
    """The message again; tuples are lists. Raises ValueError for what is no message."""
    return load_json(data, _record)


def refused(problem: BaseException) -> dict[str, Any]:
    """The answer where something was raised; `value_of` raises it on the other side."""
    return {"problem": reason_of(problem), "unknown": isinstance(problem, Unknown)}


def value_of(answer: Mapping[str, Any]) -> Any:
    """The value of an answer. Raises ActionFailed, or Unknown, for one that is `refused`."""
    if "problem" in answer:
        raise (Unknown if answer.get("unknown") else ActionFailed)(answer["problem"])
    return answer.get("value")


def _other(value: object) -> Any:
    if isinstance(value, Record) and type(value).__name__ in _RECORDS:
        return {_RECORD: type(value).__name__, **value.as_dict()}
    if isinstance(value, bytes | bytearray | memoryview):
        return {_BYTES: base64.b64encode(value).decode()}
    if hasattr(value, "tolist"):  # arrays and numbers of numpy
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} can't be handed to another process")


def _record(data: dict[str, Any]) -> Any:
    if _BYTES in data and len(data) == 1:
        return base64.b64decode(data[_BYTES])
    kind = _RECORDS.get(data[_RECORD]) if isinstance(data.get(_RECORD), str) else None
    if kind is None:
        return data
    try:
        return kind(**{name: value for name, value in data.items() if name != _RECORD})
    except TypeError as problem:
        raise ValueError(str(problem)) from None

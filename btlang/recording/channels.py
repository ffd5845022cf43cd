"""Which parts of a run go into which channel: our own events as they are, and what Foxglove has a schema for."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping

from btlang.engine.status import FAILURE, NAMES
from btlang.run.events import (
    LOGGED,
    Ended,
    Event,
    Notice,
    PeriodPassed,
    Printed,
    Said,
    Sampled,
    StatusesChanged,
    Troubled,
    Warned,
)
from btlang.run.logs import as_json, describe_event
from btlang.run.robot_state import Movements
from btlang.support.record import Record
from btlang.text.json_text import shallow
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

FRAME = "map"
"""The frame of poses; that of scans is the robot's."""
ROBOT_FRAME = "base_link"
_INFO, _WARNING, _ERROR = 2, 3, 4  # levels of foxglove.Log


class RecordingChannel(Record):
    """A topic, and the name and JSON schema of its messages."""

    topic: str
    schema: str
    described: Mapping[str, Any]


def _object(**properties: Any) -> dict[str, Any]:
    return {"type": "object", "properties": properties}


_NUMBER, _WHOLE, _TEXT = {"type": "number"}, {"type": "integer"}, {"type": "string"}
_COMMON = {"t": _NUMBER, "number": _WHOLE, "wall": _NUMBER}
_TIME = _object(sec=_WHOLE, nsec=_WHOLE)
_AXES = {"x": _NUMBER, "y": _NUMBER, "z": _NUMBER}
_POSE = _object(position=_object(**_AXES), orientation=_object(**_AXES, w=_NUMBER))

STATUSES = RecordingChannel("/btlang/statuses", "btlang.StatusesChanged", _object(
    **_COMMON, indices={"type": "array", "items": _WHOLE}, codes={"type": "array", "items": _WHOLE},
    reasons={"type": "object", "additionalProperties": _TEXT}, values={"type": "object"},
))  # fmt: skip
"""The changes of a tick: numbers of nodes in preorder, `before * 8 + status` of each, and the reasons by position."""
STATE = RecordingChannel("/robot/state", "btlang.RobotState", _object(
    **_COMMON, ticks=_WHOLE, overruns=_WHOLE, battery={"type": ["number", "null"]},
    left={"type": ["string", "null"]}, right={"type": ["string", "null"]}, pose={"type": ["array", "null"]},
))  # fmt: skip
THINGS = RecordingChannel("/robot/things", "btlang.Things", _object(
    **_COMMON, things={"type": "array", "items": {"type": "array"}},
))  # fmt: skip
"""The people and objects that moved, or that the robot begins or ceases to see: see btlang.run.robot_state.Whereabouts.
"""
VALUES = RecordingChannel("/btlang/values", "btlang.Values", _object(**_COMMON, values={"type": "object"}))
POSE = RecordingChannel("/robot/pose", "foxglove.PoseInFrame", _object(timestamp=_TIME, frame_id=_TEXT, pose=_POSE))
SCAN = RecordingChannel("/robot/scan", "foxglove.LaserScan", _object(
    timestamp=_TIME, frame_id=_TEXT, pose=_POSE, start_angle=_NUMBER, end_angle=_NUMBER,
    ranges={"type": "array", "items": _NUMBER}, intensities={"type": "array", "items": _NUMBER},
))  # fmt: skip
LOG = RecordingChannel("/log", "foxglove.Log", _object(
    timestamp=_TIME, level=_WHOLE, message=_TEXT, name=_TEXT, file=_TEXT, line=_WHOLE,
))  # fmt: skip
EVENTS = {
    kind: RecordingChannel(f"/btlang/{kind.tag}", f"btlang.{kind.__name__}", describe_event(kind))
    for kind in LOGGED
    if kind.tag
}
"""A channel for each other class of events."""
CLASSES = {channel.topic: kind for kind, channel in EVENTS.items()}


def messages(
    event: Event, nanoseconds: int, label: Callable[[Node], str], movements: Movements
) -> Iterator[tuple[RecordingChannel, dict[str, Any] | str]]:
    """Yield what is written of an event, at a time since 1970; a text is JSON already.

    `movements` are those of the file.
    """
    if isinstance(event, StatusesChanged):
        yield STATUSES, _statuses(event)
    elif isinstance(event, PeriodPassed):
        if event.state is not None and (moved := movements.changed(event.state.things)):
            yield THINGS, _common(event) | {"things": moved}
        yield from _period(event, nanoseconds)
    elif isinstance(event, Sampled):
        if event.values:
            yield VALUES, _common(event) | {"values": shallow(event.values)}
        if event.scan:
            yield SCAN, _scan(event, nanoseconds)
    elif type(event) in EVENTS:
        yield EVENTS[type(event)], as_json(event, label)
        text = _text(event)
        if text is not None:
            level, words = text
            log = {"timestamp": _time(nanoseconds), "level": level, "message": words, "name": event.tag}
            yield LOG, {**log, "file": "", "line": 0}


def _common(event: Event) -> dict[str, Any]:
    return {"t": event.t, "number": event.number, "wall": event.wall}


def _statuses(event: StatusesChanged) -> dict[str, Any]:
    changes = list(event.without_paths())
    reasons = {str(at): reason for at, (_, _, _, reason) in enumerate(changes) if reason}
    written = _common(event) | {
        "indices": [index for index, _, _, _ in changes],
        "codes": [before << 3 | status for _, status, before, _ in changes],
    }
    if reasons:
        written["reasons"] = reasons
    if event.valued:
        written["values"] = {str(index): dict(node.ports) for index, node in event.valued.items()}
    return written


def _period(event: PeriodPassed, nanoseconds: int) -> Iterator[tuple[RecordingChannel, str]]:
    """Write a period by hand, since there are so many of them: an encoder takes three times as long."""
    state = event.state
    pose = None if state is None else state.pose
    head = f'{{"t":{event.t!r},"number":{event.number},"wall":{event.wall!r},"ticks":{event.ticks}'
    head += f',"overruns":{event.overruns}'
    if state is not None:
        head += f',"battery":{_json(state.battery)},"left":{_json(state.left)},"right":{_json(state.right)}'
    if pose is None or not (math.isfinite(pose.x) and math.isfinite(pose.y) and math.isfinite(pose.heading)):
        yield STATE, head + "}"
        return
    x, y, heading = float(pose.x), float(pose.y), float(pose.heading)
    half = math.radians(heading) / 2
    yield STATE, f'{head},"pose":[{x!r},{y!r},{heading!r}]}}'
    time = f'{{"sec":{nanoseconds // 1_000_000_000},"nsec":{nanoseconds % 1_000_000_000}}}'
    turn = f'{{"x":0,"y":0,"z":{math.sin(half)!r},"w":{math.cos(half)!r}}}'
    yield (
        POSE,
        f'{{"timestamp":{time},"frame_id":"{FRAME}","pose":{{"position":{{"x":{x!r},"y":{y!r},"z":0}},"orientation":{turn}}}}}',
    )


def _json(value: object) -> str:
    return "null" if value is None or value != value else json.dumps(value)


def _scan(event: Sampled, nanoseconds: int) -> dict[str, Any]:
    step = 2 * math.pi / len(event.scan)
    ranges = [round(distance, 3) if math.isfinite(distance) else 0.0 for distance in event.scan]  # JSON has no infinity
    return {
        "timestamp": _time(nanoseconds), "frame_id": ROBOT_FRAME, "pose": _pose_here(),
        "start_angle": 0.0, "end_angle": 2 * math.pi - step, "ranges": ranges, "intensities": [],
    }  # fmt: skip


def _pose_here() -> dict[str, Any]:
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    return {"position": zero, "orientation": {**zero, "w": 1.0}}


def _time(nanoseconds: int) -> dict[str, int]:
    return {"sec": nanoseconds // 1_000_000_000, "nsec": nanoseconds % 1_000_000_000}


def _text(event: Event) -> tuple[int, str] | None:
    """Return the level and the text of an event that is for people."""
    if isinstance(event, Said | Printed):
        return _INFO, event.text
    if isinstance(event, Notice):
        return (_WARNING if isinstance(event, Warned) else _ERROR if isinstance(event, Troubled) else _INFO), event.text
    if isinstance(event, Ended):
        failed = event.outcome == NAMES[FAILURE]
        return (_ERROR if failed else _INFO), f"{event.outcome}{f': {event.reason}' if event.reason else ''}"
    return None

"""A log for programs: one line of JSON for each event."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping

from btlang.engine.status import NAMES
from btlang.run.events import Overrun, RobotEvent, StatusChanged, StatusesChanged
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    from btlang.run.events import Event

    class TextOutput(Protocol):
        """A file, or what can be written to like one."""

        def write(self, text: str, /) -> object: ...

        def flush(self) -> object: ...


class JsonLog:
    """A sink; each line is flushed, so that the log is whole up to the moment of a crash. `label` names a node."""

    def __init__(self, output: TextOutput, label: Callable[[Node], str]) -> None:
        self._output = output
        self._label = label

    def __call__(self, event: Event) -> None:
        if isinstance(event, StatusesChanged):
            for change in event:
                self._write(_status_fields(change, self._label(change.node)))
        elif isinstance(event, RobotEvent):
            self._write({**event.data, "t": _time(event.t), "event": event.kind})
        elif isinstance(event, Overrun):
            self._write(_overrun_fields(event, self._label))

    def _write(self, fields: Mapping[str, Any]) -> None:
        self._output.write(json.dumps(fields, ensure_ascii=False, default=str) + "\n")
        self._output.flush()


def _status_fields(change: StatusChanged, name: str) -> Mapping[str, Any]:
    node = change.node
    fields = {"t": _time(change.t), "path": change.path, "id": node.id, "name": name, "ports": dict(node.ports)}
    reason = {"reason": change.reason} if change.reason else {}
    return {**fields, "status": NAMES[change.status], **reason}


def _overrun_fields(event: Overrun, label: Callable[[Node], str]) -> Mapping[str, Any]:
    seconds = {"seconds": round(event.seconds, 6), "period": round(event.period, 6)}
    fields = {"t": _time(event.t), "event": "overrun", **seconds}
    node = event.node
    if node is None:
        return fields
    blamed = {"path": event.path, "id": node.id, "name": label(node)}
    return {**fields, **blamed, "leaf_seconds": round(event.leaf_seconds, 6)}


def _time(t: float) -> float:
    return round(t, 6)

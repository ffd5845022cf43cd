"""A log for programs: one line of JSON for each event."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping

from btlang.engine.status import NAMES
from btlang.run.events import Overrun, PeriodPassed, RobotEvent, StatusChanged
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
        if isinstance(event, PeriodPassed):
            return
        line = json.dumps(self._fields(event), ensure_ascii=False, default=str)
        self._output.write(line + "\n")
        self._output.flush()

    def _fields(self, event: RobotEvent | StatusChanged | Overrun) -> Mapping[str, Any]:
        t = round(event.t, 6)
        if isinstance(event, RobotEvent):
            return {**event.data, "t": t, "event": event.kind}
        if isinstance(event, Overrun):
            return self._overrun_fields(event, t)
        return _status_fields(event, t, self._label(event.node))

    def _overrun_fields(self, event: Overrun, t: float) -> Mapping[str, Any]:
        fields = {"t": t, "event": "overrun", "seconds": round(event.seconds, 6), "period": round(event.period, 6)}
        node = event.node
        if node is None:
            return fields
        blamed = {"path": event.path, "id": node.id, "name": self._label(node)}
        return {**fields, **blamed, "leaf_seconds": round(event.leaf_seconds, 6)}


def _status_fields(event: StatusChanged, t: float, name: str) -> Mapping[str, Any]:
    node = event.node
    fields = {"t": t, "path": event.path, "id": node.id, "name": name, "ports": dict(node.ports)}
    reason = {"reason": event.reason} if event.reason else {}
    return {**fields, "status": NAMES[event.status], **reason}

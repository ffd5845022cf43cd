"""Logs of a run: plain lines for people, and a line of JSON for each event for programs, with its schema."""

from __future__ import annotations

import json
from collections.abc import Callable

from btlang.engine.status import FAILURE, IDLE, NAMES, RUNNING, SKIPPED
from btlang.run.events import LOGGED, Event, Overrun, StatusChanged, StatusesChanged, Warned
from btlang.support.field_types import field_type
from btlang.text.formatting import one_line
from btlang.text.json_text import shallow
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    from btlang.run.events import Event

    class TextOutput(Protocol):
        """A file, or what can be written to like one."""

        def write(self, text: str, /) -> object: ...

        def flush(self) -> object: ...


_WORDS = {IDLE: "halted", RUNNING: "start", FAILURE: "failed", SKIPPED: "skipped"}


class PlainLines:
    """A sink that writes a line at the start and at the end of each action, and what the robot says or bumps into.

    A leaf that takes too long for a tick is reported the first time only, and so is the exception of one.
    `label` gives the words for a node, `is_action` whether it is an action; `write` gets lines without an end.
    """

    def __init__(
        self, label: Callable[[Node], str], is_action: Callable[[Node], bool], write: Callable[[str], object]
    ) -> None:
        self._label = label
        self._is_action = is_action
        self._write = write
        self._slow: set[str] = set()  # paths of leaves
        self._warned: dict[str, str] = {}  # what was said of the leaf at a path

    def __call__(self, event: Event) -> None:
        if isinstance(event, StatusesChanged):
            for change in event:
                if is_asked_wait(change.node) or self._is_action(change.node):
                    self._action(change, event.valued.get(change.index, change.node))
        elif isinstance(event, Overrun):
            self._overrun(event)
        elif words := event.words:
            if isinstance(event, Warned):
                self._warned[event.path] = event.text
            word, _, rest = words.partition(" ")
            self._line(event.t, word, rest)

    def _action(self, event: StatusChanged, node: Node) -> None:
        is_said = not event.reason or event.reason in self._warned.get(event.path, "")
        reason = "" if is_said else f": {event.reason}"
        self._line(event.t, _WORDS.get(event.status, "done"), self._label(node) + reason)

    def _overrun(self, event: Overrun) -> None:
        if event.node is not None and event.path not in self._slow:
            self._slow.add(event.path)
            took = f"took {brief(event.leaf_seconds)} s, but a tick has only {brief(event.period)} s"
            self._line(event.t, "slow", f"{self._label(event.node)}: {took}")

    def _line(self, t: float, word: str, rest: str) -> None:
        self._write(f"{t:7.2f}  {word:<6} {one_line(rest)}".rstrip())


def brief(seconds: float) -> str:
    """Write seconds with two digits that matter, however few they are."""
    return f"{seconds:.2f}" if seconds >= 0.1 else f"{seconds:.2g}"


def is_asked_wait(node: Node) -> bool:
    """Return whether a node is a wait that a sentence asks for; the timers inside `for` and `every` have no
    sentence.
    """
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.is_wait and node.span is not None


_NOT_WRITTEN = ("index",)
_STATUSES = ("status", "before")
_OPEN = ("data",)  # of which robots of others decide what is in it


class JsonLog:
    """A sink; each line is flushed, so that the log is whole up to the moment of a crash. `label` names a node."""

    def __init__(self, output: TextOutput, label: Callable[[Node], str]) -> None:
        self._output = output
        self._label = label

    def __call__(self, event: Event) -> None:
        if isinstance(event, StatusesChanged):
            for change in event:
                self._write(change)
        elif isinstance(event, LOGGED):
            self._write(event)

    def _write(self, event: Event) -> None:
        self._output.write(json.dumps(as_json(event, self._label), ensure_ascii=False, default=str) + "\n")
        self._output.flush()


def as_json(event: Event, label: Callable[[Node], str]) -> dict[str, Any]:
    """Return the fields of an event, without those that have their default.

    A node is written as its id, words and ports.
    """
    written: dict[str, Any] = {"t": event.t}
    if event.tag:
        written["event"] = event.tag
    defaults = event.field_defaults
    for name in event.fields[len(Event.fields) :]:
        value = getattr(event, name)
        if name in _NOT_WRITTEN or (name in defaults and value == defaults[name]):
            continue
        if isinstance(value, Node):
            written |= {"id": value.id, "name": label(value), "ports": dict(value.ports)}
        else:
            written[name] = NAMES[value] if name in _STATUSES else shallow(value) if name in _OPEN else value
    written |= {name: getattr(event, name) for name in Event.fields}
    return {name: round(value, 6) if isinstance(value, float) else value for name, value in written.items()}


def describe_event(kind: type[Event]) -> dict[str, Any]:
    """Return the JSON schema of one class of events."""
    properties: dict[str, Any] = {"event": {"const": kind.tag}} if kind.tag else {}
    required = list(properties)
    for name, described in _types(kind).items():
        if name in Event.fields or name in _NOT_WRITTEN:
            continue
        more = _NODE if described is _NODE else {name: described}
        if name not in kind.field_defaults:
            required += more
        elif described is not _NODE:  # a field that isn't there has its default
            more = {name: {**described, "default": kind.field_defaults[name]}}
        properties |= more
    no_event = {} if kind.tag else {"not": {"required": ["event"]}}
    text = " ".join((kind.__doc__ or "").split())
    return {"title": kind.__name__, "description": text, "properties": properties, "required": required, **no_event}


_NODE = {
    "id": {"type": "string"},
    "name": {"type": "string"},
    "ports": {"type": "object", "additionalProperties": {"type": "string"}},
}


def _types(kind: type[Event]) -> dict[str, dict[str, Any]]:
    annotations: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        annotations |= vars(base).get("__annotations__", {})
    return {name: _type(name, annotations[name]) for name in kind.fields}


def _type(name: str, annotation: str) -> dict[str, Any]:
    if name in _STATUSES:
        return {"enum": list(NAMES)}
    return _NODE if annotation in ("Node", "Node | None") else field_type(annotation)[1]

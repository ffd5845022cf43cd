"""The reader of recordings, also of those that end in the middle of a record, and their missions."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import os_error_reason
from btlang.engine.changes import Changes
from btlang.engine.compile import outline
from btlang.engine.status import NAMES
from btlang.recording.bundle import open_mission
from btlang.recording.channels import CLASSES, LOG, POSE, SCAN, STATE, STATUSES, THINGS, VALUES
from btlang.recording.recorder import ABOUT
from btlang.robots.geometry import Pose
from btlang.run.events import Event, PeriodPassed, Sampled, StatusesChanged
from btlang.run.robot_state import RobotState, Whereabouts
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Span
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Fault, NodeInstance


MOST_BYTES = 64_000_000
"""The limit of one record: a broken length would fill the memory."""
_STATUSES = range(len(NAMES))
_FOR_OTHERS = frozenset((POSE.topic, LOG.topic))  # which say again what our own messages do


class RecordedNodes:
    """The nodes of a recorded run by their numbers; see btlang.run.events.Nodes."""

    def __init__(self, nodes: Sequence[Node], parents: Sequence[int]) -> None:
        self._nodes, self._parents = nodes, parents
        self._reasons: dict[int, str] = {}

    @property
    def size(self) -> int:
        """The number of nodes."""
        return len(self._nodes)

    @cached_property
    def _places(self) -> list[int]:
        """Return which child of its parent each node is."""
        counts = [0] * len(self._nodes)
        places = []
        for parent in self._parents:
            places.append(counts[parent] if parent >= 0 else 0)
            if parent >= 0:
                counts[parent] += 1
        return places

    def path(self, index: int) -> str:
        """Return the path of a node as that of an engine: `/0/1` is the second child of the root's first one."""
        steps: list[str] = []
        while self._parents[index] >= 0:
            steps.append(str(self._places[index]))
            index = self._parents[index]
        return "/" + "/".join(reversed(steps))

    def node(self, index: int) -> Node:
        """Return the node with a number."""
        return self._nodes[index]

    def parent(self, index: int) -> int:
        """Return the number of the node above, -1 for the root."""
        return self._parents[index]

    def span(self, index: int) -> Span | None:
        """Return the sentence of a node, or of the nearest one above it that has one."""
        span = None
        while span is None and index >= 0:
            span, index = self._nodes[index].span, self._parents[index]
        return span

    def filled(self, index: int) -> Node:
        """Return the same: what its ports held is with the changes."""
        return self._nodes[index]

    def reason(self, index: int, fault: Fault | NodeInstance | None) -> str:
        """Return why a node failed, as it was written."""
        return fault if isinstance(fault, str) else ""


class Recording(Record):
    """A recording.

    `about` and `files` are those of the Recorder, `entries` the messages that are ours: topic and JSON.
    """

    about: Mapping[str, str]
    files: Mapping[str, bytes]
    entries: tuple[tuple[str, bytes], ...]

    def events(self, nodes: RecordedNodes) -> Iterator[Event]:
        """Yield what happened, as the classes of events, up to the first that is broken."""
        run = self.about.get("run", "")
        things: dict[str, Whereabouts] = {}
        began: float | None = None
        for topic, text in self.entries:
            try:
                data = json.loads(text)
                if topic == SCAN.topic:
                    event: Event | None = None if began is None else _scan(data, run, began)
                else:
                    began = data["wall"] - data["t"] if began is None else began
                    event = _event(topic, data, run, nodes, things)
            except (ValueError, KeyError, IndexError, TypeError, AttributeError, RecursionError):
                return
            if event is not None:
                yield event


def read_recording(path: str) -> Recording:
    """Raise MissionError if it isn't a recording of btlang (BT084), or can't be read (BT001)."""
    from mcap.exceptions import McapError
    from mcap.records import Attachment, Channel, Message, Metadata
    from mcap.stream_reader import StreamReader

    about: dict[str, str] = {}
    files: dict[str, bytes] = {}
    topics: dict[int, str] = {}
    entries: list[tuple[str, bytes]] = []
    try:
        with open(path, "rb") as file:
            try:
                for record in StreamReader(file, emit_chunks=True, record_size_limit=MOST_BYTES).records:
                    if isinstance(record, Message):
                        topic = topics[record.channel_id]
                        if topic not in _FOR_OTHERS:
                            entries.append((topic, record.data))
                    elif isinstance(record, Channel):
                        topics[record.id] = record.topic
                    elif isinstance(record, Metadata) and record.name == ABOUT:
                        about = dict(record.metadata)
                    elif isinstance(record, Attachment):
                        files[record.name] = record.data
            except (McapError, struct.error, EOFError, ValueError, KeyError, IndexError, OverflowError):
                pass  # it ends here: the process was killed, or the disk was full
    except OSError as error:
        raise MissionError([diagnostic("BT001", NOWHERE, file=path, reason=os_error_reason(error))]) from None
    if not about:
        raise MissionError([diagnostic("BT084", NOWHERE, file=path)])
    return Recording(about, files, tuple(entries))


def no_recording(what: str, advice: str) -> MissionError:
    """Make the error BT088."""
    return MissionError([diagnostic("BT088", NOWHERE, what=what, advice=advice)])


def read_about(path: str) -> dict[str, str]:
    """Return what a recording says of itself, from its beginning; nothing if it can't be read."""
    from mcap.exceptions import McapError
    from mcap.records import Metadata
    from mcap.stream_reader import StreamReader

    try:
        with open(path, "rb") as file:
            for record in StreamReader(file, emit_chunks=True, record_size_limit=MOST_BYTES).records:
                if isinstance(record, Metadata) and record.name == ABOUT:
                    return dict(record.metadata)
    except (OSError, McapError, struct.error, EOFError, ValueError):
        pass
    return {}


def _event(
    topic: str, data: Mapping[str, Any], run: str, nodes: RecordedNodes, things: dict[str, Whereabouts]
) -> Event | None:
    """Make an event of a message. `things` are those that were written so far."""
    if topic == STATUSES.topic:
        common = data["t"], run, data["number"], data["wall"]
        valued = {int(index): _with_ports(nodes, int(index), ports) for index, ports in data.get("values", {}).items()}
        return StatusesChanged(*common, _changes(data, nodes.size), nodes, valued)
    if topic == STATE.topic:
        common = data["t"], run, data["number"], data["wall"]
        pose = Pose(*data["pose"]) if data.get("pose") else None
        known = "battery" in data
        hands = data["left"], data["right"]
        state = RobotState(pose, data["battery"], *hands, tuple(things.values())) if known else None
        return PeriodPassed(*common, data["ticks"], data["overruns"], state, None)
    if topic == THINGS.topic:
        for name, x, y, seen in data["things"]:
            things[name] = str(name), _metres(x), _metres(y), bool(seen)
        return None
    if topic == VALUES.topic:
        return Sampled(data["t"], run, data["number"], data["wall"], data["values"])
    kind = CLASSES.get(topic)
    if kind is None:
        return None
    given = {name: data[name] for name in kind.fields if name in data}
    if "node" in kind.fields and "id" in data:
        given["node"] = Node(data["id"], (), tuple(data.get("ports", {}).items()))
    missing = [name for name in kind.fields if name not in given and name not in kind.field_defaults]
    return kind(**{**dict.fromkeys(missing), **given})


def _scan(data: Mapping[str, Any], run: str, began: float) -> Sampled:
    """Make the event of a scan, which has its time as others read it, from when the run began."""
    seconds = data["timestamp"]["sec"] + data["timestamp"]["nsec"] / 1e9
    scan = tuple(float(distance) or math.inf for distance in data["ranges"])
    return Sampled(max(0.0, seconds - began), run, 0, seconds, {}, scan)


def _metres(value: Any) -> float | None:
    return None if value is None else float(value)


def _changes(data: Mapping[str, Any], size: int) -> Changes:
    changes, reasons = Changes(), data.get("reasons", {})
    for at, (index, code) in enumerate(zip(data["indices"], data["codes"], strict=True)):
        if not 0 <= index < size:
            raise ValueError("there's no such node")
        if code & 7 not in _STATUSES or code >> 3 not in _STATUSES:
            raise ValueError("there's no such status")
        changes.add(index, code >> 3, code & 7, reasons.get(str(at)))
    return changes


def _with_ports(nodes: RecordedNodes, index: int, ports: Mapping[str, str]) -> Node:
    node: Node = nodes.node(index).replace(ports=tuple(ports.items()))
    return node


_MAGIC = b"\x89MCAP0\r\n"


def is_recording(path: str) -> bool:
    """Return whether the file begins as a recording does."""
    try:
        with open(path, "rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except OSError:
        return False


@contextmanager
def open_recording(
    path: str, keywords: Sequence[str] | None = None
) -> Iterator[tuple[Recording, Mission, RecordedNodes]]:
    """Give a recording, its mission and the nodes of that; with `keywords` the mission may be run, without them it has
    all words that are kept with it.

    Raises MissionError.
    """
    recording = read_recording(path)
    name, language = recording.about.get("mission") or "a mission", recording.about.get("language", "en")
    with open_mission(recording.files, name, language, keywords, _values_of(recording)) as mission:
        yield recording, mission, RecordedNodes(*outline(mission.tree))


def _values_of(recording: Recording) -> dict[str, object]:
    try:
        values = json.loads(recording.about.get("values", "{}"))
    except ValueError:
        return {}
    return values if isinstance(values, dict) else {}

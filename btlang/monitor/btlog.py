"""Writes a recorded run as a log file of BehaviorTree.CPP (FileLogger2), which Groot2 opens."""

from __future__ import annotations

import struct
from collections.abc import Iterable

from btlang.monitor.groot_protocol import CODES, transition
from btlang.monitor.groot_tree import GrootTree
from btlang.run.events import Event, StatusesChanged

MAGIC = b"BTCPP4-FileLogger2"
_FORMAT = 1


def to_btlog(tree: GrootTree, events: Iterable[Event]) -> bytes:
    """The file: the tree, the wall time at which the run began, and each change with its time since then."""
    xml = tree.to_xml().encode("utf-8", "replace")
    began: float | None = None
    changes: list[bytes] = []
    for event in events:
        if began is None:
            began = event.wall - event.t
        if isinstance(event, StatusesChanged):
            at = max(0, int(event.t * 1e6))  # mission time: a pause is no part of it
            changes += [
                transition(at, index + 1, CODES[status]) for index, status, _, _ in event.changes if index < tree.size
            ]
    head = MAGIC + bytes([_FORMAT]) + struct.pack("<i", len(xml))
    return b"".join((head, xml, struct.pack("<q", int((began or 0.0) * 1e6)), *changes))

"""Protocol 2 of Groot2, as BehaviorTree.CPP 4 speaks it (groot2_protocol.h): its messages as bytes."""

from __future__ import annotations

import struct

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.support.record import Record

PROTOCOL = 2
FULL_TREE, STATUS, BLACKBOARDS = b"T", b"S", b"B"
HOOK_INSERT, HOOK_REMOVE, HOOKS_DUMP = b"I", b"R", b"D"
REMOVE_ALL_HOOKS, DISABLE_ALL_HOOKS = b"A", b"X"
BREAKPOINT_REACHED, BREAKPOINT_UNLOCK = b"N", b"U"
TOGGLE_RECORDING, TRANSITIONS = b"r", b"t"

MOST_NODES = 65_535
"""The most nodes: they have numbers of 16 bits, from 1 on."""
MOST_TRANSITIONS = 1_000
"""The number of latest transitions that are kept for a client that records."""
RESET = 10
"""A number that is added to the last status of a node that was reset."""
CODES = {IDLE: 0, RUNNING: 1, SUCCESS: 2, FAILURE: 3, SKIPPED: 4}
NAMES = {"IDLE": IDLE, "RUNNING": RUNNING, "SUCCESS": SUCCESS, "FAILURE": FAILURE, "SKIPPED": SKIPPED}
_HEADER = struct.Struct("<BcI")
_STATUS = struct.Struct("<HB")
_TRANSITION = struct.Struct("<IHHB")  # the time has 6 bytes


class GrootRequest(Record):
    """The head of a request: a letter, and a number that the reply repeats."""

    letter: bytes
    number: int


def read_request(head: bytes) -> GrootRequest:
    """Raise ValueError for what is no head of a request."""
    if len(head) != _HEADER.size:
        raise ValueError("wrong request header")
    protocol, letter, number = _HEADER.unpack(head)
    if protocol != PROTOCOL:
        raise ValueError(f"protocol {protocol} instead of {PROTOCOL}")
    return GrootRequest(letter, number)


def head(letter: bytes, number: int, tree_id: bytes = b"") -> bytes:
    """Return the head of a request, or with the id of the tree (16 bytes) that of a reply."""
    return _HEADER.pack(PROTOCOL, letter, number) + tree_id


def statuses(codes: bytes) -> bytes:
    """Return the numbers of all nodes with their codes, in order."""
    return b"".join(map(_STATUS.pack, range(1, len(codes) + 1), codes))


def transition(microseconds: int, uid: int, code: int) -> bytes:
    """Return a change of a status, at a time since the recording began."""
    return _TRANSITION.pack(microseconds & 0xFFFFFFFF, microseconds >> 32 & 0xFFFF, uid, code)

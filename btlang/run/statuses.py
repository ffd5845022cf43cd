"""Statuses for people who use the library."""

from __future__ import annotations

from enum import IntEnum

from btlang.engine import status


class Status(IntEnum):
    """A status of a node or a mission. Equal to the numbers of btlang.engine.status."""

    FAILURE = status.FAILURE
    SUCCESS = status.SUCCESS
    RUNNING = status.RUNNING
    SKIPPED = status.SKIPPED
    IDLE = status.IDLE

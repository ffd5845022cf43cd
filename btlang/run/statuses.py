"""Statuses for people who use the library."""

from __future__ import annotations

from enum import Enum

from btlang.engine import status


class Status(int, Enum):
    """A status of a node or a mission. Equal to the numbers of btlang.engine.status; printed by its name."""

    FAILURE = status.FAILURE
    SUCCESS = status.SUCCESS
    RUNNING = status.RUNNING
    SKIPPED = status.SKIPPED
    IDLE = status.IDLE

    def __str__(self) -> str:
        return self.name

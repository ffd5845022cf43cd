"""The robot as actions see it, and why it cannot do something. What it can do is in `capabilities.py`."""

from __future__ import annotations

from btlang.engine.leaves.leaf import ActionFailed, Unknown
from btlang.robots.capabilities import CompletedOperation, Hand, OnEvent, Operation, Robot

__all__ = ["CompletedOperation", "Hand", "OnEvent", "Operation", "Robot", "RobotError", "SensorSilent"]


class RobotError(ActionFailed):
    """Why the robot can't do a command, in plain English: a leaf that lets it pass FAILS with it."""


class SensorSilent(RobotError, Unknown):
    """What was asked for is not known: a sensor says nothing, or nothing that can be true."""

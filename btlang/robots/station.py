"""A charging station as a robot drives into it."""

from __future__ import annotations

from btlang.robots.geometry import Pose
from btlang.support.record import Record


class Station(Record):
    """A dock by its name. A robot that is connected stands at its `spot`, and drives straight in from `staging`."""

    name: str
    spot: Pose
    staging: Pose

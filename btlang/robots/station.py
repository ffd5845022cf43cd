"""A charging station as a robot drives into it."""

from __future__ import annotations

from btlang.record import Record
from btlang.robots.geometry import Pose


class Station(Record):
    """A dock by its name. A robot that is connected stands at its `spot`, and drives straight in from `staging`."""

    name: str
    spot: Pose
    staging: Pose

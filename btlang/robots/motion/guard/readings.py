"""Readings of sensors, by which the guard judges: each has a time stamp, a source, and a reason if it is invalid."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from btlang.robots.geometry import Pose
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.scan import Array


class SensorReading(Record):
    """What a sensor said. `source` is its name, `stamp` the second of the guard's clock at which it was measured.

    `fault` says why the reading isn't to be believed, in the words of the sensor: "/scan repeats its time stamp"; it is
    "" if the reading is valid.
    """

    source: str
    stamp: float
    fault: str = ""


class ScanReading(SensorReading):
    """A reading of a scanner that looks `view` degrees wide, in the middle `angle` degrees left of ahead.

    `ranges` gives 360 metres from the centre of the robot, index = degrees left of its heading: inf where a valid beam
    found nothing, NaN where no valid beam looked. It is only called where it matters: `room` metres around the rim are
    known to be free without it. With `free_way`, the metres that are free in a direction are known without it, too.
    `content` is a number that changes whenever the ranges do, inf if they can't be frozen.
    """

    ranges: Callable[[], Array] | None = None
    view: float = 360.0
    angle: float = 0.0
    room: float = 0.0
    content: float = inf
    free_way: Callable[[float], float] | None = None


class RangeReading(SensorReading):
    """A reading of a distance sensor on the rim: metres to what is nearest, inf for nothing; it looks `angle` degrees
    left of ahead."""

    distance: float = 0.0
    angle: float = 0.0


class ContactReading(SensorReading):
    """A reading of a bumper whose middle is `angle` degrees left of ahead."""

    pressed: bool = False
    angle: float = 0.0


class OdometryReading(SensorReading):
    """Where the robot is by its odometry, which may have begun anywhere."""

    pose: Pose = Pose(0.0, 0.0)
    measured: float | None = None
    """Seconds by the clock of its source, where it has one: `stamp` may be that of an arrival, which may be late."""


class JointReading(SensorReading):
    """Where a joint is: degrees, or metres if it slides."""

    position: float = 0.0


ObstacleReading = ScanReading | RangeReading | ContactReading
"""Readings that say what is near."""
Sensors = Callable[[], "list[ObstacleReading]"]
"""Gives the readings of all sensors that look out for obstacles, as they are now."""

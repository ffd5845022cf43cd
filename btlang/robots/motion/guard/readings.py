"""Readings of sensors, by which the guard judges, and whether their time stamps and percentages can be true."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from btlang.robots.geometry import Pose
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.worlds.scan import Array

Sensors = Callable[[], "list[ObstacleReading]"]
"""A function that returns the current readings of all sensors for obstacles."""
_LATE = 0.7  # seconds more than usual that a message may be under way
_EARLY = 0.3  # seconds before its measurement that a message seems to arrive: its clock has been set
_BACK = 1e-6
_LEARNING = 2.0  # seconds from the first message in which one may show that the ones before were held up
_AGAIN = 3.0  # seconds in which stamps go on steadily after a jump, until they are believed again
_JUMP, _FASTEST = 10.0, 1.0  # percent that a gauge may jump, and a second that a battery gains or loses at most
_HOLDS = 0.9  # seconds that another charge has to be reported for: drivers may repeat a sample
_COUNTS = 3.0  # seconds


class SensorReading(Record):
    """A reading of a sensor. `source` is its name, `stamp` the second of the guard's clock at which it was measured.

    `fault` is why the reading isn't believed, in the words of the sensor: "/scan repeats its time stamp"; "" for a
    valid one.
    """

    source: str
    stamp: float
    fault: str = ""


class ScanReading(SensorReading):
    """A reading of a scanner that looks `view` degrees wide, in the middle `angle` degrees left of ahead.

    `ranges` returns 360 metres from the centre of the robot, index = degrees left of its heading: inf if a valid beam
    found nothing, NaN if no valid beam looked. It is only called if it matters: `room` metres around the rim are known
    to be free without it. With `free_way`, the metres that are free in a direction are known without it, too. `content`
    is a number that changes whenever the ranges do, inf if they can't be frozen.
    """

    ranges: Callable[[], Array] | None = None
    view: float = 360.0
    angle: float = 0.0
    room: float = 0.0
    content: float = inf
    free_way: Callable[[float], float] | None = None


class RangeReading(SensorReading):
    """A reading of a distance sensor on the rim: metres to the nearest thing, inf for nothing.

    It looks `angle` degrees left of ahead.
    """

    distance: float = 0.0
    angle: float = 0.0


class ContactReading(SensorReading):
    """A reading of a bumper whose middle is `angle` degrees left of ahead."""

    pressed: bool = False
    angle: float = 0.0


class OdometryReading(SensorReading):
    """The pose by odometry, which may have begun anywhere."""

    pose: Pose = Pose(0.0, 0.0)
    measured: float | None = None
    """Seconds by the clock of its source, if it has one: `stamp` may be the time of a late arrival."""


ObstacleReading = ScanReading | RangeReading | ContactReading
"""A reading of what is near."""


class StampCheck:
    """A check of the time stamps of one sensor, in the order of arrival. In seconds; a stamp of 0 means none.

    The offset between both clocks is learnt from the message that was under way for the shortest time.
    """

    def __init__(self) -> None:
        self._before: float | None = None
        self._offset: float | None = None
        self._steady_since: float | None = None
        self._first: float | None = None
        self._last = 0.0

    def fault(self, stamp: float, arrival: float, lags: bool = True) -> str:
        """Return why a stamp can't be true, to be read after the name of the sensor; "" if it can.

        Without `lags` the time under way isn't judged: the clock of the stamps may be faster than real time.
        """
        if stamp == 0.0:
            return ""
        before, self._before = self._before, stamp
        self._last, last = arrival, self._last
        if before is not None and stamp == before:
            return "repeats its time stamp"
        if before is not None and stamp < before - _BACK:
            return self._on_jump(f"has time stamps that go back by {before - stamp:.2f} s", arrival, last)
        if not lags:
            return ""
        under_way = arrival - stamp
        if self._offset is None or self._first is None:
            self._offset, self._first = under_way, arrival
        late = under_way - self._offset
        if late > _LATE:
            return self._on_jump(f"is {late:.1f} s old", arrival, last, under_way)
        held_up = arrival - self._first < _LEARNING and late > -_LEARNING
        if late < -_EARLY and not held_up:
            return self._on_jump(f"has time stamps that are {-late:.1f} s in the future", arrival, last, under_way)
        self._offset, self._steady_since = min(self._offset, under_way), None
        return ""

    def _on_jump(self, reason: str, arrival: float, last: float, under_way: float | None = None) -> str:
        """Believe a clock that was set once its stamps have been steady for a while."""
        if self._steady_since is None or under_way is None or arrival - last > _LATE:
            self._steady_since = arrival
        if under_way is not None and arrival - self._steady_since > _AGAIN:
            self._offset, self._steady_since = under_way, None
            return ""
        return reason


class ChargeCheck:
    """A check of the percentages of one battery, in order. A jump that no battery makes has to be reported twice."""

    def __init__(self) -> None:
        self._believed: tuple[float, float] | None = None  # percent, and when
        self._doubted: tuple[float, float] | None = None

    def believes(self, percent: float, now: float) -> bool:
        """Return whether a percentage counts, at a second of any clock."""
        if self._believed is None or self._follows(self._believed, percent, now):
            self._believed, self._doubted = (percent, now), None
        elif self._doubted is None or not self._follows(self._doubted, percent, now):
            self._doubted = percent, now
        elif now - self._doubted[1] >= _HOLDS:
            self._believed, self._doubted = (percent, now), None
        return self._doubted is None

    def is_recent(self, now: float) -> bool:
        """Return whether a percentage was believed recently, so that it still counts while another one is doubted."""
        return self._believed is not None and now - self._believed[1] <= _COUNTS

    def fault(self, percent: float, now: float) -> str:
        """Return why a percentage isn't believed, to be read after the name of the sensor; "" if it is."""
        before = self._believed
        return "" if self.believes(percent, now) or before is None else f"jumps from {before[0]:.0f}% to {percent:.0f}%"

    @staticmethod
    def _follows(before: tuple[float, float], percent: float, now: float) -> bool:
        return abs(percent - before[0]) <= _JUMP + _FASTEST * (now - before[1])

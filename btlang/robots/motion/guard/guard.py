"""The guard of a base: it judges each velocity before it is sent, and gives one reason why it allows less."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from math import copysign, cos, degrees, inf, isfinite, isnan, radians, sqrt

from btlang.robots.bodies.body import Body
from btlang.robots.geometry import Pose, wrap
from btlang.robots.motion.guard.readings import (
    ContactReading,
    ObstacleReading,
    OdometryReading,
    RangeReading,
    ScanReading,
    SensorReading,
    Sensors,
)
from btlang.robots.motion.guard.regions import Regions, WalkingPeople, safe_among
from btlang.robots.motion.guard.tracking import STANDS, OdometryCheck
from btlang.robots.robot import RobotError
from btlang.robots.zones import Zones
from btlang.support.record import Record

FASTEST, FASTEST_TURN = 20.0, degrees(30.0)
"""Metres and degrees a second that no robot exceeds."""
FRESH = 0.6
"""Seconds after which a reading doesn't count for driving any more."""
_BLIND, _OFTEN = (
    0.3,
    0.25,
)  # metres that it may go without news of a sensor, and the seconds between these that are usual
_MARGIN = 0.035  # metres that stay free: less than planners keep beside the robot
_DELAY = 0.1  # seconds until it brakes
_LOOKS = 60.0  # degrees from the way: sensors that look farther aside say nothing about it
_STANDS = 0.02  # metres a second: less is standing
_TOUCHING = 0.3  # seconds for which it counts that somebody wants to touch what is ahead
_BESIDE = 1e-3  # metres
_ROUNDING = 1.0 + 1e-9
_LATE = 0.05  # metres
_STEP = 0.3  # metres between two looks at a sensor, after which nothing is known of the time between


class Cause(Enum):
    """The cause of a limit that the guard sets."""

    NONE, OBSTACLE, ZONE, SENSOR, ODOMETRY, PERSON = range(6)


_PATIENCE = {Cause.NONE: inf, Cause.OBSTACLE: 1.0, Cause.ZONE: 1.0, Cause.SENSOR: 2.0, Cause.ODOMETRY: 0.0}
"""Seconds after which a drive that the guard holds has failed; for people it is the patience of the body."""


class Verdict(Record):
    """The velocity that may be sent, in metres and degrees a second, and why it is less than the wanted one.

    `who` is the name of the person or the zone in the way.
    """

    linear: float
    angular: float
    reason: str = ""
    cause: Cause = Cause.NONE
    who: str = ""


class Guard:
    """The guard of one base. `judge` is for one thread.

    `sensors` returns the readings of the sensors for obstacles, `odometry` the latest odometry, None if it isn't known.
    `pose` is where the robot is on the map of zones and people; None likewise.

    Not seen is not clear: a sensor that looks in the direction of travel and reports nothing, or nothing that can be
    true, stops the robot.
    """

    def __init__(
        self,
        body: Body,
        zones: Zones,
        people: WalkingPeople,
        *,
        sensors: Sensors,
        odometry: Callable[[], OdometryReading | None],
        pose: Callable[[], Pose | None],
        now: Callable[[], float],
    ) -> None:
        self._body, self._people, self._regions = body, people, Regions(zones, body.radius, body.driving.brake)
        self._sensors, self._odometry, self._pose, self._now = sensors, odometry, pose, now
        self._check = OdometryCheck(body)
        self._checked = -inf  # the stamp of the odometry that was compared last
        self._disagrees = ""
        self._direction = 0.0, 0.0
        # what a sensor said last, how far the robot had gone when it said so first (by odometry, by commands), and how
        # far when it was asked last
        self._seen: dict[str, tuple[float, float, float, float]] = {}
        self._stands_since: float | None = None
        self._touches_until, self._touches = -inf, False
        self.verdict = Verdict(0.0, 0.0)
        """The latest verdict."""

    @property
    def held(self) -> str:
        """Why it has held the robot back for so long that a drive has failed; "" if it hasn't."""
        verdict, since = self.verdict, self._stands_since
        if since is None or self._now() - since < _PATIENCE.get(verdict.cause, self._body.patience):
            return ""
        return verdict.reason

    @property
    def stuck(self) -> bool:
        """Whether the odometry shows no motion although some was commanded."""
        return self._disagrees == STANDS

    def touch(self) -> None:
        """Allow the robot to touch what is ahead, at the contact speed of its body. Repeat this, as velocities are."""
        self._touches_until = self._now() + _TOUCHING

    def rest(self) -> None:
        """End a drive; the next one is judged independently."""
        self._check.rest()
        self._disagrees, self._stands_since = "", None

    def forget(self) -> None:
        """Forget the motion so far: somebody else moved the robot, or will."""
        self.rest()
        self._check.forget()

    def judge(self, linear: float, angular: float, may_touch: bool = True) -> Verdict:
        """Return the velocity that may be sent in place of a wanted one, in metres and degrees a second.

        On a journey, the robot may not touch what is ahead, even if something else allows it. Raises RobotError for a
        velocity that isn't finite, or is faster than any robot.
        """
        check_velocity(linear, angular)
        now = self._now()
        self._touches = may_touch and now < self._touches_until
        verdict = self._find_verdict(linear, angular, now)
        self._check.sent(now, verdict.linear, verdict.angular)
        self.verdict = verdict
        stands = abs(verdict.linear) < min(_STANDS, abs(linear)) or (verdict.angular == 0.0 != angular)
        if not (verdict.reason and stands):
            self._stands_since = None
        elif self._stands_since is None:
            self._stands_since = now
        return verdict

    def _find_verdict(self, linear: float, angular: float, now: float) -> Verdict:
        reading = self._odometry()
        if reading is not None and not reading.fault and reading.stamp != self._checked:
            self._checked = reading.stamp
            fault = self._check.fault(reading.pose, reading.stamp, reading.measured)
            self._disagrees = self._disagrees or fault
        direction = copysign(1.0, linear) if linear else 0.0, copysign(1.0, angular) if not linear else 0.0
        if direction != self._direction or linear == 0.0 == angular:
            self._direction = direction
            self.rest()  # the way back is another drive
        if linear == 0.0 == angular:
            return Verdict(0.0, 0.0)
        if reading is not None and self._disagrees:
            return Verdict(0.0, 0.0, f"{reading.source} {self._disagrees}", Cause.ODOMETRY)
        if reading is not None and (fault := _fault(reading, now)):
            return Verdict(0.0, 0.0, fault, Cause.SENSOR)
        if reading is not None and (blind := _blind_speed(reading, now)) < abs(linear):
            linear = copysign(blind, linear)
        if linear == 0.0:
            return Verdict(0.0, angular)
        most, reason, cause, who = self._safe(linear < 0.0, abs(linear), now)
        if most >= abs(linear):
            return Verdict(linear, angular)
        return Verdict(copysign(most, linear) if most else 0.0, angular, reason, cause, who)

    def _safe(self, backward: bool, wanted: float, now: float) -> tuple[float, str, Cause, str]:
        """Return the metres a second that are safe straight ahead or backward, and what limits them most."""
        found = wanted, "", Cause.NONE, ""
        pose = self._pose()
        if pose is not None:
            if self._people.walking:
                most, who = safe_among(self._people, pose, backward, self._body.radius, self._body.driving.brake)
                if most < found[0]:
                    found = most, f"{who} is in the way", Cause.PERSON, who
            most, who = self._regions.safe(pose, backward)
            if most < found[0]:
                found = most, f"the {who} is in the way, where the robot may not go" if who else "", Cause.ZONE, who
        for reading in self._sensors():
            most, reason, cause = self._by_sensor(reading, backward, found[0], now)
            if most < found[0]:
                found = most, reason, cause, ""
        return found

    def _by_sensor(
        self, reading: ObstacleReading, backward: bool, wanted: float, now: float
    ) -> tuple[float, str, Cause]:
        if not _looks(reading, backward):
            return inf, "", Cause.NONE
        if fault := _fault(reading, now):
            return 0.0, fault, Cause.SENSOR
        side = "behind" if backward else "ahead"
        if isinstance(reading, ContactReading):
            return (
                (0.0, f"the {reading.source} is pressed", Cause.OBSTACLE) if reading.pressed else (inf, "", Cause.NONE)
            )
        blind = _blind_speed(reading, now)
        if blind < wanted:
            return blind, f"{reading.source} is silent for {now - reading.stamp:.1f} s", Cause.SENSOR
        if isinstance(reading, RangeReading):
            free = reading.distance
            frozen = self._since_changed(reading.source, free)
        else:
            brake = self._body.driving.brake
            frozen = self._since_changed(reading.source, reading.content)
            if reading.room - frozen - _MARGIN >= wanted * _DELAY + wanted * wanted / (2 * brake):
                return inf, "", Cause.NONE
            try:
                free = self._free_way(reading, 180.0 if backward else 0.0)
            except RobotError as problem:
                return 0.0, str(problem), Cause.SENSOR
        if isnan(free):
            return 0.0, f"{reading.source}: no valid beam looks {side}", Cause.SENSOR
        left = free - frozen
        most = self._before_contact(left - _MARGIN)
        if self._touches:
            most = max(most, self._body.contact_speed)
        if left < free - _MARGIN and free > 2 * _MARGIN:
            return most, f"{reading.source}: shows the same for {free - left:.2f} m of the way", Cause.SENSOR
        return most, f"{reading.source}: {max(0.0, free):.2f} m {side}", Cause.OBSTACLE

    def _free_way(self, reading: ScanReading, direction: float) -> float:
        """Return the metres that are free, as `free_way` of the corridor does."""
        if reading.free_way is not None:
            return reading.free_way(direction)
        assert reading.ranges is not None
        from btlang.robots.motion.guard.corridor import free_way  # numpy takes longer to import than many missions

        view = reading.view - 2 * abs(wrap(reading.angle - direction)) if reading.view < 360.0 else 360.0
        return free_way(reading.ranges(), direction, self._body.radius - _BESIDE, view)

    def _since_changed(self, sensor: str, said: float) -> float:
        """Return the metres that the robot has gone since a sensor's reading changed: the sensor may be frozen."""
        rolled, commanded = self._check.rolled, self._check.commanded
        before, since, commanded_since, asked = self._seen.get(sensor, (inf, 0.0, 0.0, 0.0))
        if before != said or not isfinite(said) or rolled - asked > _STEP:
            since, commanded_since = rolled, commanded
        self._seen[sensor] = said, since, commanded_since, rolled
        gone = max(rolled - since, commanded - commanded_since)  # either may lie
        return gone + _LATE if gone > _LATE else gone  # it may have been old when it came first

    def _before_contact(self, gap: float) -> float:
        """Return the speed at which the robot still stops before something so far away, if it brakes a moment later."""
        if gap <= 0.0:
            return 0.0
        lost = self._body.driving.brake * _DELAY
        return sqrt(lost * lost + 2 * self._body.driving.brake * gap) - lost


class Guarded:
    """A robot whose base a guard judges; see the protocol Base."""

    _guard: Guard

    @property
    def held_back(self) -> str:
        return self._guard.held

    @property
    def limited_by(self) -> str:
        return self._guard.verdict.reason

    def touch(self) -> None:
        self._guard.touch()


def check_velocity(linear: float, angular: float) -> None:
    """Raise RobotError for metres and degrees a second that aren't finite, or are faster than any robot."""
    if not isfinite(linear) or not isfinite(angular):
        raise RobotError(f"a velocity of {linear:g} m/s and {radians(angular):g} rad/s is not finite")
    if abs(linear) > FASTEST or abs(angular) > FASTEST_TURN * _ROUNDING:
        raise RobotError(
            f"a velocity of {linear:.3g} m/s and {radians(angular) + 0.0:.3g} rad/s is beyond the limits of the robot"
        )


def _looks(reading: ObstacleReading, backward: bool) -> bool:
    """Return whether a sensor looks in the direction of travel."""
    away = abs(wrap(reading.angle - 180.0 * backward))
    if isinstance(reading, ScanReading):
        return away <= reading.view / 2
    return cos(radians(away)) >= cos(radians(_LOOKS)) - 1e-9


def _blind_speed(reading: SensorReading, now: float) -> float:
    """Return the speed at which a robot doesn't go too far until a sensor reports again, or it stops."""
    age = now - reading.stamp
    return _BLIND / age if age > _OFTEN else inf


def _fault(reading: SensorReading, now: float) -> str:
    """Return why a reading isn't believed now, "" if it is."""
    age = now - reading.stamp
    return reading.fault or (f"{reading.source} is silent for {age:.1f} s" if age > FRESH else "")

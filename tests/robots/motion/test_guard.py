"""What the guard lets a base do, by readings that the test gives."""

from __future__ import annotations

from math import inf, nan
from typing import Any

import numpy as np
import pytest

from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.guard import Cause, Guard, Verdict
from btlang.robots.motion.guard.readings import ContactReading, OdometryReading, RangeReading, ScanReading, StampCheck
from btlang.robots.motion.guard.tracking import JointProgress
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world import Zone
from btlang.robots.zones import Zones

BODY = standard_body()
HALL = Zone("hall", "slow", ((-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)), 5.0)
STAIRS = Zone("stairs", "slow", ((1.0, -1.0), (3.0, -1.0), (3.0, 1.0), (1.0, 1.0)), 5.0)


class Bench:
    """A guard with readings that a test sets, at a time that it sets."""

    def __init__(self, *readings: Any, zones: tuple[Zone, ...] = ()) -> None:
        self.readings, self.now, self.pose = list(readings), 0.0, Pose(0.0, 0.0)
        self.walking: dict[str, tuple[float, float, float]] = {}
        self.zones = Zones(zones)
        self.odometry: OdometryReading | None = None
        self.guard = Guard(
            BODY, self.zones, self, sensors=lambda: self.readings, odometry=lambda: self.odometry,
            pose=lambda: self.pose, now=lambda: self.now,
        )  # fmt: skip

    def wall_between(self, a: object, b: object) -> bool:
        return False

    def judge(self, linear: float = 0.5, angular: float = 0.0) -> Verdict:
        return self.guard.judge(linear, angular)

    def drive(self, seconds: float, linear: float, moves: Any, age: Any = lambda t: 0.0) -> str:
        """Drives while the odometry moves so and comes so late; why it was stopped."""
        for _ in range(round(seconds / 0.05)):
            self.now += 0.05
            measured = self.now - age(self.now)
            self.pose = Pose(*moves(measured))
            self.odometry = OdometryReading("odometry", self.now, "", self.pose, 70.0 + measured)
            self.judge(linear)
            if self.guard.held:
                return self.guard.held
        return ""


def scan(*fault: str, stamp: float = 0.0, view: float = 360.0, **beams: float) -> ScanReading:
    ranges = np.full(360, inf)
    for beam, metres in beams.items():
        ranges[int(beam[1:]) % 360] = metres
    return ScanReading("scanner", stamp, *(fault or [""]), lambda: ranges, view, 0.0, -inf, inf)


@pytest.mark.parametrize(
    ("reading", "speed", "reason"),
    [
        (scan(), 0.5, ""),
        (scan(b0=2.0), 0.5, ""),
        (scan(b0=0.23), 0.0, "scanner: 0.03 m ahead"),
        (scan(b180=0.21), 0.5, ""),
        (scan(b0=nan, b1=nan, b2=nan, b3=nan, b4=nan, b5=nan), 0.0, "scanner: no valid beam looks ahead"),
        (scan("/scan is broken"), 0.0, "/scan is broken"),
        (scan(stamp=-0.7), 0.0, "scanner is silent for 0.7 s"),
        (RangeReading("sonar", 0.0, "", 0.03), 0.0, "sonar: 0.03 m ahead"),
        (RangeReading("sonar", 0.0, "", 0.03, 180.0), 0.5, ""),
        (RangeReading("sonar", 0.0, "", 0.03, 50.0), 0.0, "sonar: 0.03 m ahead"),
        (RangeReading("sonar", 0.0, "", 0.03, 70.0), 0.5, ""),
        (RangeReading("sonar", 0.0, "", inf), 0.5, ""),
        (ContactReading("bumper", 0.0, "", True), 0.0, "the bumper is pressed"),
        (ContactReading("bumper", 0.0, "", False), 0.5, ""),
        (ContactReading("bumper", 0.0, "", True, 180.0), 0.5, ""),
    ],
)
def test_one_reading(reading: Any, speed: float, reason: str) -> None:
    verdict = Bench(reading).judge()
    assert (verdict.linear, verdict.reason) == (speed, reason)


def test_a_scanner_that_does_not_look_behind_says_nothing_of_it() -> None:
    assert Bench(scan("broken", view=180.0)).judge(-0.5).linear == -0.5
    assert Bench(scan("broken", view=360.0)).judge(-0.5).linear == 0.0
    assert Bench(scan(b180=0.23)).judge(-0.5).reason == "scanner: 0.03 m behind"


def test_it_slows_down_before_it_stops_and_may_always_turn() -> None:
    verdict = Bench(scan(b0=0.27)).judge(0.5, 30.0)
    assert 0.1 < verdict.linear < 0.4
    assert verdict.angular == 30.0
    assert Bench(scan(b0=0.2)).judge(0.0, 30.0) == Verdict(0.0, 30.0)


def test_who_may_touch_drives_on_slowly() -> None:
    bench = Bench(scan(b0=0.21))
    bench.guard.touch()
    assert bench.judge().linear == BODY.contact_speed
    assert bench.guard.judge(0.5, 0.0, may_touch=False).linear == 0.0
    bench.now = 0.4
    bench.readings = [scan(b0=0.21, stamp=0.4)]
    assert bench.judge().linear == 0.0


def test_a_drive_has_failed_once_it_has_stood_for_a_while() -> None:
    bench = Bench(RangeReading("sonar", 0.0, "", 0.03))
    bench.judge()
    assert bench.guard.held == ""
    for now in (0.5, 1.0):
        bench.now = now
        bench.readings = [RangeReading("sonar", now, "", 0.03)]
        bench.judge()
    assert bench.guard.held == "sonar: 0.03 m ahead"
    bench.judge(-0.5)
    assert bench.guard.held == ""


def test_who_walks_is_waited_for() -> None:
    bench = Bench()
    bench.walking = {"Vera": (0.52, 0.0, 0.25)}
    assert bench.judge() == Verdict(0.0, 0.0, "Vera is in the way", Cause.PERSON, "Vera")
    bench.walking = {"Vera": (-0.55, 0.0, 0.25)}
    assert bench.judge().linear == 0.5


def test_zones_are_closed_while_a_restriction_holds() -> None:
    bench = Bench(zones=(HALL, STAIRS))
    bench.pose = Pose(0.78, 0.0)
    assert bench.judge().linear == 0.5
    with bench.zones.keep_out("Stairs"), bench.zones.keep_out("stairs"):
        assert bench.judge().reason == "the stairs is in the way, where the robot may not go"
        bench.zones.open("stairs")
        assert bench.judge().linear == 0.0
    assert bench.judge().linear == 0.5


def test_it_stays_in_the_zones_that_it_is_confined_to() -> None:
    bench = Bench(zones=(HALL, STAIRS))
    bench.pose = Pose(1.75, 0.0)
    with bench.zones.keep_in("hall"):
        assert bench.judge().linear == 0.0
        assert bench.judge(-0.5).linear == -0.5
        assert bench.zones.refusal("lab", (2.5, 0.0)) == "the lab is outside the hall, where the robot has to stay"
        bench.pose = Pose(2.5, 0.0)  # somebody put it there
        assert bench.judge().linear == 0.0
        assert bench.judge(-0.5).linear == -0.5
    bench.pose = Pose(1.75, 0.0)
    with bench.zones.keep_in("hall", "stairs"):
        assert bench.judge().linear == 0.5
    with bench.zones.keep_in("hall"), bench.zones.keep_in("stairs"):
        bench.pose = Pose(1.5, 0.0, 90.0)
        assert bench.judge().linear > 0.3
        bench.pose = Pose(1.5, 0.75, 90.0)
        assert bench.judge().linear == 0.0


@pytest.mark.parametrize("linear", [nan, inf, 30.0])
def test_no_velocity(linear: float) -> None:
    with pytest.raises(RobotError, match="a velocity of"):
        Bench().judge(linear)


@pytest.mark.parametrize(
    ("moves", "reason"),
    [
        (lambda t: (0.5 * t, 0.0, 0.0), ""),
        (lambda t: (0.45 * t, 0.0, 0.0), ""),
        (lambda t: (0.5 * max(0.0, t - 0.3), 0.0, 0.0), ""),
        (lambda t: (-0.5 * t, 0.0, 0.0), "odometry shows -0."),
        (lambda t: (0.05 * t, 0.0, 0.0), "odometry shows 0.0"),
        (lambda t: (0.0, 0.5 * t, 0.0), "odometry shows 0.00 m where"),
        (lambda t: (5.0 * t, 0.0, 0.0), "odometry shows"),
        (lambda t: (0.0, 0.0, 0.0), "odometry shows that the robot doesn't move"),
    ],
)
def test_odometry(moves: Any, reason: str) -> None:
    found = Bench().drive(3.0, 0.5, moves)
    assert found.startswith(reason)
    assert bool(found) is bool(reason)


def test_odometry_that_came_late_is_not_too_fast() -> None:
    """After a pause of the process it catches up: more way in less time, by the clock of who reads it."""
    assert Bench().drive(3.0, 0.5, lambda t: (0.5 * t, 0.0, 0.0), lambda t: 0.4 if t < 2.0 else 0.0) == ""
    assert "odometry shows" in Bench().drive(3.0, 0.5, lambda t: (0.5 * t if t < 2.0 else 3.0 * t - 5.0, 0.0, 0.0))


def test_a_base_that_was_held_up_may_catch_up() -> None:
    """For a quarter of a second it reports no motion, in the next one all of it."""

    def held_up(t: float) -> tuple[float, float, float]:
        return (0.75 if 1.5 <= t < 1.75 else t - 1.0 if 1.75 <= t < 2.0 else 0.5 * t), 0.0, 0.0

    assert Bench().drive(3.0, 0.5, held_up) == ""


def test_a_disagreement_ends_one_drive_and_not_the_next() -> None:
    bench = Bench()
    assert bench.drive(3.0, 0.5, lambda t: (-0.5 * t, 0.0, 0.0))
    assert bench.judge().cause is Cause.ODOMETRY
    bench.judge(0.0)
    assert bench.judge().linear == 0.5


def test_stamps() -> None:
    stamps = StampCheck()
    skew = 1e6  # the clocks of two computers
    for arrival in (0.0, 0.1, 0.2):
        assert stamps.fault(skew + arrival, arrival + 0.05) == ""
    assert stamps.fault(skew + 0.2, 0.3) == "repeats its time stamp"
    assert stamps.fault(skew + 0.1, 0.4) == "has time stamps that go back by 0.10 s"
    assert stamps.fault(skew + 0.45, 1.7) == "is 1.2 s old"
    assert stamps.fault(skew + 11.75, 1.8) == "has time stamps that are 10.0 s in the future"
    assert stamps.fault(0.0, 1.9) == ""


def test_first_messages_that_were_held_up_say_nothing_of_the_clock() -> None:
    """A busy process reads them late, and the next one on time, which seems to come from the future."""
    stamps = StampCheck()
    for sent, read in ((0.0, 0.6), (0.1, 0.61), (0.6, 0.65), (0.7, 0.75)):
        assert stamps.fault(sent, read) == ""
    assert stamps.fault(1.2, 2.1) == "is 0.9 s old"
    assert stamps.fault(3.2, 2.8) == "has time stamps that are 0.5 s in the future"


def test_a_clock_that_was_set_is_believed_after_a_while() -> None:
    stamps = StampCheck()
    assert stamps.fault(100.0, 0.0) == ""
    found = [stamps.fault(110.0 + 0.1 * step, 0.1 * step) for step in range(1, 40)]
    assert found[0] == "has time stamps that are 10.0 s in the future"
    assert found[-1] == ""


def test_joints_have_the_patience_of_the_body() -> None:
    bench = Bench()
    joints = JointProgress(BODY.replace(patience=2.0), lambda: bench.now)
    joints.start(["head turn"])
    for bench.now, left in ((1.0, 50.0), (2.0, 40.0), (4.0, -40.0)):
        assert not joints.has_arrived("head turn", left)
    bench.now = 4.1
    with pytest.raises(RobotError, match="the head turn doesn't move: it is 40 degrees from where it should be"):
        joints.has_arrived("head turn", 40.0)
    assert joints.has_arrived("head turn", 0.5)

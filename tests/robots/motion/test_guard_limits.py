"""Where exactly the guard begins to slow a base down, what it remembers of a drive, and what it forgets."""

from __future__ import annotations

from math import degrees, inf, nan

import pytest

from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.guard import FASTEST, FASTEST_TURN, FRESH, Cause, Guarded, check_velocity
from btlang.robots.motion.guard.readings import ContactReading, OdometryReading, RangeReading, ScanReading
from btlang.robots.robot import RobotError
from tests.robots.motion.test_guard import BODY, Bench, scan


def odometry(x: float, at: float, fault: str = "") -> OdometryReading:
    return OdometryReading("odometry", at, fault, Pose(x, 0.0))


@pytest.mark.parametrize(
    ("linear", "angular"), [(FASTEST, 0.0), (-FASTEST, 0.0), (0.0, FASTEST_TURN), (0.0, -degrees(30.0))]
)
def test_the_fastest_velocities(linear: float, angular: float) -> None:
    check_velocity(linear, angular)
    with pytest.raises(RobotError, match="beyond the limits"):
        check_velocity(linear * 1.001, angular * 1.001)


@pytest.mark.parametrize(("linear", "angular"), [(nan, 0.0), (0.0, nan), (inf, 0.0), (0.0, -inf)])
def test_velocities_that_are_none(linear: float, angular: float) -> None:
    bench = Bench()
    with pytest.raises(RobotError, match="is not finite"):
        bench.judge(linear, angular)


def test_who_wants_to_stand_may_stand() -> None:
    bench = Bench(ContactReading("bumper", 0.0, "", True))
    bench.odometry = odometry(0.0, 0.0, "it is broken")
    assert (bench.judge(0.0, 0.0).linear, bench.judge(0.0, 0.0).reason) == (0.0, "")


@pytest.mark.parametrize("linear", [0.4, -0.4])
def test_odometry_that_is_silent_or_broken_stops_the_base(linear: float) -> None:
    bench = Bench()
    bench.odometry = odometry(0.0, 0.0, "it is broken")
    assert (bench.judge(linear, 9.0).linear, bench.guard.verdict.angular) == (0.0, 0.0)
    assert (bench.guard.verdict.reason, bench.guard.verdict.cause) == ("it is broken", Cause.SENSOR)
    bench.odometry = odometry(0.0, 0.0)
    bench.now = FRESH
    assert bench.judge(linear).reason == ""
    bench.now = FRESH + 0.05
    assert bench.judge(linear).reason == "odometry is silent for 0.7 s"


@pytest.mark.parametrize(("age", "speed"), [(0.0, 2.0), (0.25, 2.0), (0.5, 0.6), (0.6, 0.5)])
def test_news_that_is_old_slows_the_base_down(age: float, speed: float) -> None:
    """It goes 0.3 m at most without news, of a sensor as of the odometry."""
    bench = Bench()
    bench.odometry, bench.now = odometry(0.0, 0.0), age
    for way in (1.0, -1.0):
        assert bench.judge(2.0 * way, 3.0).linear == pytest.approx(speed * way)
        assert bench.guard.verdict.angular == 3.0
    bench = Bench(scan())
    bench.now = age
    verdict = bench.judge(2.0)
    assert verdict.linear == pytest.approx(speed)
    assert verdict.reason == (f"scanner is silent for {age:.1f} s" if speed < 2.0 else "")
    assert verdict.cause is (Cause.SENSOR if speed < 2.0 else Cause.NONE)


@pytest.mark.parametrize("free", [0.05, 0.1, 0.3, 1.0])
def test_it_stands_before_what_is_ahead(free: float) -> None:
    """From the speed that is allowed it brakes after a tenth of a second, and 3.5 cm stay free."""
    verdict = Bench(RangeReading("sonar", 0.0, "", free)).judge(5.0)
    speed, brake = verdict.linear, BODY.driving.brake
    assert speed * 0.1 + speed * speed / (2 * brake) == pytest.approx(free - 0.035)
    assert (verdict.reason, verdict.cause) == (f"sonar: {free:.2f} m ahead", Cause.OBSTACLE)
    assert Bench(RangeReading("sonar", 0.0, "", free)).judge(speed).reason == ""
    assert Bench(RangeReading("sonar", 0.0, "", 0.035)).judge(0.5).linear == 0.0


def test_room_that_is_known_to_be_free_is_enough() -> None:
    def looked_at(direction: float) -> float:
        asked.append(direction)
        return 0.5

    asked: list[float] = []
    stops = 0.5 * 0.1 + 0.25 / (2 * BODY.driving.brake) + 0.035
    for room, linear, expected in ((stops + 1e-6, 0.5, []), (stops - 1e-3, 0.5, [0.0]), (stops - 1e-3, -0.5, [180.0])):
        asked.clear()
        verdict = Bench(ScanReading("scanner", 0.0, room=room, free_way=looked_at)).judge(linear)
        assert asked == expected
        assert verdict.linear == linear

    def broken(_direction: float) -> float:
        raise RobotError("the scanner is gone")

    verdict = Bench(ScanReading("scanner", 0.0, free_way=broken)).judge(0.5)
    assert (verdict.linear, verdict.reason, verdict.cause) == (0.0, "the scanner is gone", Cause.SENSOR)


@pytest.mark.parametrize(("angle", "looks"), [(60.0, True), (61.0, False), (-60.0, True), (-61.0, False)])
def test_which_sensors_look_ahead(angle: float, looks: bool) -> None:
    assert (Bench(ContactReading("bumper", 0.0, "", True, angle)).judge().linear == 0.0) == looks


def test_a_sensor_that_shows_the_same_for_some_way_is_not_believed_on() -> None:
    """By the odometry, and by the commands: either may lie."""
    bench = Bench(RangeReading("sonar", 0.0, "", 0.4))
    for step in range(8):
        bench.now = step * 0.1
        bench.readings = [RangeReading("sonar", bench.now, "", 0.4)]
        bench.odometry = odometry(0.04 * step, bench.now)
        verdict = bench.judge(0.4)
    assert verdict.reason.startswith("sonar: shows the same for 0.33 m of the way")
    assert verdict.cause is Cause.SENSOR
    bench.readings = [RangeReading("sonar", bench.now, "", 0.39)]
    assert bench.judge(0.4).reason == ""


def test_a_touch_lasts_a_moment_and_is_slow() -> None:
    bench = Bench(RangeReading("sonar", 0.0, "", 0.0))
    bench.guard.touch()
    assert bench.judge(0.5).linear == BODY.contact_speed
    assert bench.guard.judge(0.5, 0.0, may_touch=False).linear == 0.0
    bench.now = 0.29
    assert bench.judge(0.5).linear == BODY.contact_speed
    bench.now = 0.31
    bench.readings = [RangeReading("sonar", bench.now, "", 0.0)]
    assert bench.judge(0.5).linear == 0.0


def test_a_drive_that_is_held_back_fails_after_a_while_and_the_next_one_is_judged_for_itself() -> None:
    bench = Bench(ContactReading("bumper", 0.0, "", True))

    def judge(at: float, linear: float = 0.5) -> str:
        bench.now = at
        bench.readings = [ContactReading("bumper", at, "", True)]
        bench.judge(linear)
        return bench.guard.held

    assert [judge(at) for at in (0.0, 0.5, 0.99)] == ["", "", ""]
    assert judge(1.0) == "the bumper is pressed"
    bench.guard.rest()
    assert bench.guard.held == ""
    assert judge(1.5) == ""
    assert judge(2.5) == "the bumper is pressed"
    assert judge(2.6, -0.5) == ""
    assert judge(2.7) == judge(3.6) == ""
    assert judge(3.7) == "the bumper is pressed"


def test_wheels_that_do_not_turn() -> None:
    bench = Bench()
    assert not bench.guard.stuck
    assert "no motion" in bench.drive(6.0, 0.5, lambda t: (0.0, 0.0)) or bench.guard.held
    assert bench.guard.stuck
    assert bench.judge(0.5).cause is Cause.ODOMETRY
    bench.guard.forget()
    assert not bench.guard.stuck
    assert bench.judge(0.5).reason == ""
    assert not bench.guard.held


def test_a_jump_while_somebody_else_moves_the_robot_is_forgotten() -> None:
    bench = Bench()
    assert bench.drive(2.0, 0.5, lambda t: (0.5 * t, 0.0)) == ""
    bench.guard.forget()
    assert bench.drive(2.0, 0.5, lambda t: (9.0 + 0.5 * t, 0.0)) == ""


def test_what_a_robot_says_of_its_guard() -> None:
    class Base(Guarded):
        def __init__(self, bench: Bench) -> None:
            self._guard = bench.guard

    bench = Bench(ContactReading("bumper", 0.0, "", True))
    base = Base(bench)
    bench.judge()
    assert (base.limited_by, base.held_back) == ("the bumper is pressed", "")
    bench.now = 1.0
    bench.readings = [ContactReading("bumper", 1.0, "", True)]
    bench.judge()
    assert base.held_back == "the bumper is pressed"
    bench.readings = [RangeReading("sonar", 1.0, "", 0.0)]
    base.touch()
    assert bench.judge(0.5).linear == BODY.contact_speed

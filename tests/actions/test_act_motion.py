"""Driving and turning: how exact, how it fails, how it halts."""

from math import hypot

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from btlang.actions import motion
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose, wrap
from btlang.robots.worlds.world import Person, Place, WorldFault

WALL = {"walls": (((1.0, -2.0), (1.0, 2.0)),)}
BLIND = standard_body().replace(sensors=())
FIXTURE = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@FIXTURE
@given(distance=st.floats(0.01, 5), heading=st.floats(-180, 180), speed=st.sampled_from([None, 0.1, 0.5, 3.0]))
def test_forward_is_exact(bench, distance, heading, speed):
    b = bench(start=Pose(0.0, 0.0, heading))
    b.run(motion.move_forward, distance=distance, speed=speed)
    b.tick(20)
    assert Pose(0.0, 0.0, heading).progress_of(b.robot.pose) == pytest.approx(distance, abs=0.01)
    assert hypot(b.robot.pose.x, b.robot.pose.y) == pytest.approx(distance, abs=0.01)


@FIXTURE
@given(angle=st.floats(1, 720))
def test_turns_are_exact(bench, angle):
    for leaf, sign in ((motion.turn_left, 1), (motion.turn_right, -1)):
        b = bench()
        b.run(leaf, angle=angle)
        b.tick(20)
        assert abs(wrap(b.robot.pose.heading - sign * angle)) < 0.6
        assert (b.robot.pose.x, b.robot.pose.y) == (0.0, 0.0)


def test_backward_and_around(bench):
    b = bench()
    b.run(motion.move_backward, distance=2.0)
    assert b.robot.pose.x == pytest.approx(-2.0, abs=0.01)
    b.run(motion.turn_around)
    assert abs(b.robot.pose.heading) == pytest.approx(180, abs=1)


def test_no_distance_takes_no_time(bench):
    assert bench().run(motion.move_forward, distance=0.0) == (None, 0.0)


def test_speed_and_its_limit(bench):
    slow, normal, fast = (bench().run(motion.move_forward, distance=3.0, speed=s)[1] for s in (0.2, None, 9.0))
    assert slow == pytest.approx(3.0 / 0.2, abs=1.5)
    assert normal == pytest.approx(3.0 / 0.5, abs=2)
    assert 3.0 < fast < normal


def test_keeps_straight_with_a_slipping_wheel(bench):
    b = bench(faults=(WorldFault("slip", wheel="left", grip=0.8),))
    b.run(motion.move_forward, distance=3.0)
    assert b.robot.pose.x == pytest.approx(3.0, abs=0.01)
    assert abs(b.robot.pose.heading) < 20


@pytest.mark.parametrize("late", [0.2, 0.6, 1.0, 1.5])
def test_commands_that_arrive_late(bench, late):
    """A busy machine or network: the robot settles instead of swinging round the goal."""
    b = bench()
    _, seconds = b.run(lambda robot, **ports: motion.move_forward(Late(robot, late), **ports), distance=0.3)
    assert seconds < 30
    assert b.robot.pose.x == pytest.approx(0.3, abs=0.02)
    b = bench()
    b.run(lambda robot, **ports: motion.turn_left(Late(robot, late), **ports), angle=90.0)
    assert b.robot.pose.heading == pytest.approx(90.0, abs=1.0)


class Late:
    """A robot that hears each drive command some seconds late."""

    def __init__(self, robot, seconds):
        self._robot, self._seconds, self._waiting = robot, seconds, []

    def __getattr__(self, name):
        return getattr(self._robot, name)

    def drive(self, linear, angular):
        now = self._robot.time
        self._waiting.append((now + self._seconds, linear, angular))
        while self._waiting and self._waiting[0][0] <= now:
            self._robot.drive(*self._waiting.pop(0)[1:])


def test_bumps_fail(bench):
    """Only a robot that doesn't see runs into things."""
    b = bench(body=BLIND, **WALL)
    with pytest.raises(ActionFailed, match=r"^bumped into something after 0\.80 m$"):
        b.run(motion.move_forward, distance=2.0)
    b.tick(5)
    assert not b.robot.moving
    with pytest.raises(ActionFailed, match=r"^bumped into something after 0\.00 m$"):
        b.run(motion.move_forward, distance=2.0)
    b.run(motion.move_backward, distance=0.5)


def test_it_stops_before_what_its_scanner_sees(bench):
    b = bench(**WALL)
    for so_far in ("0.77", "0.00"):
        with pytest.raises(ActionFailed, match=rf"^stopped after {so_far} m: scanner: 0\.04 m ahead$"):
            b.run(motion.move_forward, distance=2.0)
    assert b.robot.bumps == 0
    b.run(motion.move_backward, distance=0.5)


@pytest.mark.parametrize(
    ("leaf", "ports", "so_far"),
    [(motion.move_forward, {"distance": 1.0}, r"0\.00 m"), (motion.turn_left, {"angle": 90.0}, "0 degrees")],
)
def test_no_grip_fails(bench, leaf, ports, so_far):
    b = bench(faults=(WorldFault("slip", grip=0.0),))
    for _ in range(2):  # each attempt has its second
        begin = b.clock.now
        with pytest.raises(ActionFailed, match=rf"^stuck after {so_far}: the wheels turn but the robot doesn't move$"):
            b.run(leaf, **ports)
        assert b.clock.now - begin > 0.9


def test_an_empty_battery_fails(bench):
    b = bench(battery=0.1)
    with pytest.raises(ActionFailed, match=r"^the battery is empty after 0\.\d+ m$"):
        b.run(motion.move_forward, distance=5.0)


@pytest.mark.parametrize(
    ("leaf", "ports"), [(motion.move_forward, {"distance": 3.0}), (motion.turn_left, {"angle": 300.0})]
)
def test_halting_brakes(bench, leaf, ports):
    b = bench()
    running = b.begin(leaf, 1.5, **ports)
    assert b.robot.moving
    running.close()
    b.tick(6)
    assert not b.robot.moving
    assert b.robot.pose.x < 1.0


def test_an_emergency_stop_ends_the_action(bench):
    b = bench()
    running = b.begin(motion.move_forward, 1.5, distance=3.0)
    b.robot.stop()
    with pytest.raises(ActionFailed, match=r"^the robot was stopped$"):
        next(running)
    b.tick(3)
    assert not b.robot.moving


def test_stop_waits_for_rest(bench):
    b = bench()
    b.robot.drive(1.0, 90.0)
    b.tick(40)
    _, seconds = b.run(motion.stop)
    assert 0.3 < seconds < 0.7
    assert not b.robot.moving


def test_facing(bench, table):
    b = bench(table, places=(Place("x", -1.0, -1.0),))
    for leaf, ports in (
        (motion.face_person, {"person": "Alice"}),
        (motion.face_object, {"object": "ball"}),
        (motion.face_place, {"place": "x"}),
    ):
        b.run(leaf, **ports)
        b.tick(10)
        assert abs(b.robot.pose.bearing_to(b.robot.locate(*ports.values()))) < 1


def test_people_in_the_way_count_as_something(bench):
    b = bench(body=BLIND, people=(Person("Alice", 1.0, 0.0, 0.25),))
    with pytest.raises(ActionFailed, match=r"bumped into something after 0\.55 m"):
        b.run(motion.move_forward, distance=2.0)

"""The scanner against exact geometry."""

from math import cos, degrees, inf, nan, radians, sin, sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from btlang.robots.bodies.body import Sensor
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose, wrap
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.scan import Scanner, around
from btlang.robots.worlds.sight import View
from btlang.robots.worlds.world import Person, World, WorldFault

SQUARE = World(start=Pose(2.0, 2.0), walls=(((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)),))

RANGE = 8.0


def scan(obstacles: Obstacles, pose: Pose) -> Any:
    """What a new scanner sees."""
    return Scanner(obstacles, RANGE).read(pose)


def test_a_square_room():
    ranges = scan(Obstacles(SQUARE), Pose(2.0, 2.0, 0.0))
    assert ranges[0] == ranges[90] == pytest.approx(2.0)
    assert ranges[45] == pytest.approx(2 * sqrt(2))
    assert ranges[30] == pytest.approx(2 / cos(radians(30)))


@settings(max_examples=50, deadline=None)
@given(st.floats(0.3, 3.7), st.floats(0.3, 3.7), st.integers(-3, 3))
def test_beams_count_from_the_heading_counter_clockwise(x, y, quarter):
    ranges = scan(Obstacles(SQUARE), Pose(x, y, 90.0 * quarter))
    walls = [4.0 - x, 4.0 - y, x, y]  # east, north, west, south
    for beam in range(4):
        assert ranges[90 * beam] == pytest.approx(walls[(beam + quarter) % 4])


@settings(max_examples=100, deadline=None)
@given(
    st.builds(Pose, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-180, 180)),
    st.dictionaries(st.integers(0, 359), st.floats(1.0, 7.0)),
)
def test_what_a_mounted_scanner_measures_is_around_the_robot(at, echoes):
    points = [(distance * cos(radians(beam)), distance * sin(radians(beam))) for beam, distance in echoes.items()]
    ranges = np.array([inf, nan, *(at.distance_to(point) for point in points)])
    angles = np.array([0.0, 1.0, *(radians(at.bearing_to(point)) for point in points)])
    wanted = np.full(360, nan)
    wanted[round(at.heading) % 360] = inf  # where a beam looked that found nothing
    found = around(ranges, angles, at)
    assert [found[beam] for beam in echoes] == pytest.approx(list(echoes.values()))
    looked = (*echoes, at.heading, at.heading + degrees(1.0))
    away = np.array([min(abs(wrap(beam - other)) for other in looked) for beam in range(360)])
    assert np.isnan(found[away > 20]).all()


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-180, 180))
def test_an_inverse_pose_sees_the_origin(x, y, heading):
    pose = Pose(x, y, heading)
    back = pose.inverse
    assert pose.ahead(back.x, back.y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert back.inverse.ahead(0.0) == pytest.approx((x, y), abs=1e-9)


def test_a_camera_sees_from_where_it_is():
    """Behind the corner that hides Alice from the centre of the robot."""
    world = World(start=Pose(0.0, 0.0), walls=(((0.5, -2.0), (0.5, 0.2)),), people=(Person("Alice", 2.0, -0.5, 0.25),))
    body = standard_body()
    eyes = [body.replace(sensors=(Sensor("camera", "eye", 6.0, recognizes=6.0, ahead=at),)) for at in (0.0, 0.6)]
    seen = [View(Obstacles(world), each, lambda joint: 0.0).point("Alice", Pose(0.0, 0.0)) for each in eyes]
    assert seen == [None, (2.0, -0.5)]


def test_discs_and_what_stands_behind():
    world = World(start=Pose(0, 0), people=(Person("Alice", 3.0, 0.0, 0.25), Person("Bob", 5.0, 0.0, 0.25)))
    ranges = scan(Obstacles(world), Pose(0.0, 0.0, 0.0))
    assert ranges[0] == pytest.approx(2.75)
    assert ranges[180] == inf
    assert ranges[90] == inf


def test_out_of_range_is_infinite():
    world = World(start=Pose(0, 0), walls=(((RANGE + 0.1, -5.0), (RANGE + 0.1, 5.0)),))
    assert scan(Obstacles(world), Pose(0, 0))[0] == inf
    assert scan(Obstacles(world), Pose(0.2, 0))[0] == pytest.approx(RANGE - 0.1)


def test_an_empty_world():
    assert (scan(Obstacles(World(start=Pose(0, 0))), Pose(0, 0)) == inf).all()


def test_it_is_computed_once_until_something_moves():
    robot = SimulatedRobot(SQUARE.replace(people=(Person("Alice", 3.5, 3.5, 0.25),)))
    first = robot.scan()
    robot.step(0.05)
    assert robot.scan() is first
    assert not first.flags.writeable
    robot.move_thing("alice", 3.0, 2.0)
    assert robot.scan()[0] == pytest.approx(0.75)
    robot.drive(0.5, 0.0)
    robot.step(0.05)
    robot.drive(0.0, 0.0)
    for _ in range(20):
        robot.step(0.05)
    assert robot.scan()[0] == pytest.approx(2.75 - robot.pose.x)


def test_a_silent_scanner_says_so():
    robot = SimulatedRobot(SQUARE.replace(faults=(WorldFault("silent scanner", start=1.0, end=2.0),)))
    robot.scan()
    robot.step(1.5)
    with pytest.raises(RobotError, match="the laser scanner is silent"):
        robot.scan()
    robot.step(1.0)
    robot.scan()

"""The scanner against exact geometry."""

from math import cos, inf, radians, sqrt
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from btlang.robots.geometry import Pose
from btlang.robots.obstacles import Obstacles
from btlang.robots.robot import RobotError
from btlang.robots.scan import Scanner
from btlang.robots.simulated import SimulatedRobot
from btlang.robots.world import Fault, Person, World

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
    robot = SimulatedRobot(SQUARE.replace(faults=(Fault("silent scanner", start=1.0, end=2.0),)))
    robot.scan()
    robot.step(1.5)
    with pytest.raises(RobotError, match="the laser scanner is silent"):
        robot.scan()
    robot.step(1.0)
    robot.scan()

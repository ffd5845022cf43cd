"""The drive: distances, limits, walls, slipping wheels, determinism."""

from math import hypot

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose, segment_distance, wrap
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import FurnitureBox, Person, Place, World, WorldFault

ROOM = World(
    start=Pose(2.0, 2.0, 0.0),
    walls=(((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)),),
    boxes=(FurnitureBox(3.2, 3.2, 0.6, 0.4),),
    people=(Person("Alice", 0.8, 3.0, 0.25),),
)
EMPTY = World(start=Pose(0.0, 0.0, 0.0))
BODY = standard_body()
BLIND = BODY.replace(sensors=())


def run(robot, seconds, dt=0.05):
    for _ in range(round(seconds / dt)):
        robot.step(dt)


def test_drives_with_limited_acceleration_and_speed():
    robot = SimulatedRobot(EMPTY)
    robot.drive(5.0, 0.0)
    before, speeds = 0.0, []
    for _ in range(60):
        robot.step(0.05)
        speeds.append(robot.velocity[0])
        assert robot.velocity[0] - before <= BODY.driving.acceleration * 0.05 + 1e-9
        before = robot.velocity[0]
    assert speeds[-1] == robot.max_speed
    assert robot.pose.x == pytest.approx(3.0 - 0.5, abs=0.02)


def test_brakes_within_its_limit_and_harder_in_an_emergency():
    rolled = {}
    for emergency in (False, True):
        robot = SimulatedRobot(EMPTY)
        robot.drive(1.0, 0.0)
        run(robot, 2)
        x = robot.pose.x
        if emergency:
            robot.stop()
        else:
            robot.drive(0.0, 0.0)
        assert robot.moving
        run(robot, 1)
        assert not robot.moving
        assert robot.velocity == (0.0, 0.0)
        rolled[emergency] = robot.pose.x - x
    assert rolled[False] == pytest.approx(1 / (2 * BODY.driving.brake), abs=0.02)
    assert rolled[True] == pytest.approx(1 / (2 * BODY.driving.hard_brake), abs=0.02)


def test_turning_is_counter_clockwise_positive():
    robot = SimulatedRobot(EMPTY)
    robot.drive(0.0, 45.0)
    run(robot, 1)
    assert 30 < robot.pose.heading < 45
    assert (robot.pose.x, robot.pose.y) == (0.0, 0.0)


def test_the_size_of_steps_hardly_matters():
    ends = []
    for dt in (0.02, 0.1, 0.5):
        robot = SimulatedRobot(EMPTY)
        robot.drive(0.5, 30.0)
        run(robot, 5, dt)
        ends.append((robot.pose.x, robot.pose.y, robot.pose.heading))
    assert ends[0] == pytest.approx(ends[1], abs=0.1)
    assert ends[0] == pytest.approx(ends[2], abs=0.1)


def test_stops_at_a_wall_bumps_once_and_gets_stuck():
    events = []
    robot = SimulatedRobot(ROOM, lambda kind, data: events.append((kind, dict(data))), BLIND)
    robot.drive(0.5, 0.0)
    run(robot, 8)
    assert robot.pose.x == pytest.approx(4.0 - BODY.radius, abs=1e-4)
    assert robot.bumped
    assert robot.bumps == 1
    assert robot.stuck
    assert events == [("bump", {"into": "a wall"}), ("stuck", {})]
    robot.drive(-0.3, 0.0)
    run(robot, 1)
    assert not robot.bumped
    assert not robot.stuck


def test_a_second_push_is_a_second_bump():
    robot = SimulatedRobot(ROOM, body=BLIND)
    for bumps in (1, 2):
        robot.drive(0.5, 0.0)
        run(robot, 5)
        assert robot.bumps == bumps
        robot.drive(0.0, 0.0)
        robot.step(0.05)


def test_people_are_bumped_into_by_name():
    events = []
    robot = SimulatedRobot(
        ROOM.replace(start=Pose(0.8, 1.5, 90.0)), lambda kind, data: events.append((kind, dict(data))), BLIND
    )
    robot.drive(0.5, 0.0)
    run(robot, 5)
    assert ("bump", {"into": "Alice"}) in events
    assert robot.pose.y == pytest.approx(3.0 - 0.25 - BODY.radius, abs=1e-4)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-180, 180), st.floats(0.05, 2)), min_size=1, max_size=12))
def test_never_penetrates(commands):
    robot = SimulatedRobot(ROOM)
    for linear, angular, seconds in commands:
        robot.drive(linear, angular)
        run(robot, seconds)
        point = robot.pose.x, robot.pose.y
        assert min(segment_distance(point, s) for s in ROOM.segments()) >= BODY.radius - 1e-9
        assert hypot(point[0] - 0.8, point[1] - 3.0) >= 0.25 + BODY.radius - 1e-9
        assert not ROOM.boxes[0].contains(point)


def test_the_same_commands_give_the_same_run():
    def poses():
        robot = SimulatedRobot(ROOM)
        found = []
        for i in range(400):
            robot.drive((i % 7 - 2) / 5, i % 100 - 30)
            robot.step(0.05)
            found.append(robot.pose)
        return found

    assert poses() == poses()


def test_slipping_wheels():
    both = SimulatedRobot(EMPTY.replace(faults=(WorldFault("slip", grip=0.5),)))
    both.drive(0.5, 0.0)
    run(both, 4)
    assert both.pose.x == pytest.approx(0.5 * (0.5 * 4 - 0.125), abs=0.02)
    left = SimulatedRobot(EMPTY.replace(faults=(WorldFault("slip", start=1.0, wheel="left", grip=0.8),)))
    left.drive(0.5, 0.0)
    run(left, 0.9)
    assert left.pose.heading == 0.0
    run(left, 2)
    assert left.pose.heading > 10  # the right wheel overtakes


def test_no_grip_is_stuck():
    robot = SimulatedRobot(EMPTY.replace(faults=(WorldFault("slip", grip=0.0),)))
    robot.drive(0.5, 0.0)
    run(robot, 0.9)
    assert not robot.stuck
    run(robot, 0.3)
    assert robot.stuck
    assert robot.pose == EMPTY.start


def test_something_put_onto_the_robot_lets_it_drive_away():
    robot = SimulatedRobot(ROOM)
    robot.move_thing("Alice", 1.9, 2.0)
    robot.drive(0.5, 0.0)
    run(robot, 2)
    assert robot.pose.x > 2.5


def test_nearest_names_what_is_there():
    obstacles = Obstacles(ROOM)
    assert obstacles.nearest(3.5, 1.0) == (pytest.approx(0.5), "a wall")
    assert obstacles.nearest(0.8, 2.5) == (pytest.approx(0.25), "Alice")
    assert Obstacles(EMPTY).nearest(0, 0)[1] == "nothing"


def test_walls_hide_and_furniture_does_not():
    obstacles = Obstacles(ROOM)
    assert obstacles.wall_between((2, 2), (5, 2))
    assert not obstacles.wall_between((2, 2), (3.8, 3.8))


@pytest.mark.parametrize(("angle", "wrapped"), [(0, 0), (180, 180), (-180, 180), (270, -90), (720, 0), (-270, 90)])
def test_wrap(angle, wrapped):
    assert wrap(angle) == wrapped


def test_poses():
    pose = Pose(1.0, 1.0, 90.0)
    assert pose.bearing_to((0.0, 1.0)) == pytest.approx(90.0)
    assert pose.ahead(2.0, 1.0) == pytest.approx((0.0, 3.0))
    assert pose.progress_of(Pose(5.0, 0.5)) == pytest.approx(-0.5)
    assert pose.distance_to((4.0, 5.0)) == pytest.approx(5.0)


def test_the_battery_drains_faster_while_driving_and_strands_the_robot_when_empty():
    idle, busy = SimulatedRobot(EMPTY), SimulatedRobot(EMPTY)
    busy.drive(1.0, 0.0)
    run(idle, 60)
    run(busy, 60)
    assert 99 < idle.battery < 100
    assert busy.battery < idle.battery - 5
    events = []
    tired = SimulatedRobot(EMPTY.replace(battery=0.05), lambda kind, data: events.append(kind))
    tired.drive(1.0, 0.0)
    run(tired, 10)
    assert tired.battery == 0.0
    assert not tired.moving
    assert events == ["battery"]


def test_docking_charges_and_driving_off_undocks():
    events = []
    world = EMPTY.replace(battery=50.0, places=(Place("dock", 0.0, 0.0),), dock=Place("dock", 0.0, 0.0, 0.0))
    robot = SimulatedRobot(world, lambda kind, data: events.append(kind))
    robot.dock()
    assert robot.charging
    run(robot, 30)
    assert robot.battery == 100.0
    assert robot.docked
    assert not robot.charging
    robot.drive(0.5, 0.0)
    run(robot, 2)
    assert not robot.docked
    assert events == ["dock", "undock"]

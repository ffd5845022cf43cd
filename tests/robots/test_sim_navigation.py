"""Journeys: they arrive, never bump, and say why when there is no way."""

from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from btlang.robots.geometry import Pose, segment_distance
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.planning_grid import ClearanceGrid
from btlang.robots.worlds.world import FurnitureBox, Person, Place, World, WorldFault
from btlang.robots.worlds.world_file import load_world

WORLDS = Path(__file__).parents[2] / "examples" / "worlds"
HOUSE = load_world()


def travel(robot, name, seconds=120):
    journey = robot.navigate_to(name)
    for _ in range(seconds * 20):
        if journey.done:
            break
        robot.step(0.05)
    return journey


@pytest.mark.parametrize("file", [None, "walled_room", "museum", "warehouse"])
def test_every_name_of_every_world_is_reached_without_a_bump(file):
    world = load_world(file and WORLDS / f"{file}.toml")
    robot = SimulatedRobot(world)
    for name in (*world.names.places, *world.names.objects, *world.names.people, *world.names.places[::-1]):
        journey = travel(robot, name)
        assert journey.done
        assert journey.failure is None
        away = robot.pose.distance_to(robot.locate(name))
        assert away < (0.05 if name in world.names.places else 0.9)
        if name not in world.names.places:
            assert abs(robot.pose.bearing_to(robot.locate(name))) < 2
    assert robot.bumps == 0


@settings(max_examples=25, deadline=None)
@given(st.floats(0.3, 11.7), st.floats(0.3, 7.7), st.floats(-180, 180), st.sampled_from(HOUSE.names.places))
def test_from_anywhere(x, y, heading, place):
    assume(not any(box.contains((x, y)) for box in HOUSE.boxes))
    assume(min(segment_distance((x, y), segment) for segment in HOUSE.segments()) > 0.21)
    assume(all(Pose(t.x, t.y).distance_to((x, y)) > t.radius + 0.21 for t in (*HOUSE.people, *HOUSE.objects)))
    robot = SimulatedRobot(HOUSE.replace(start=Pose(x, y, heading)))
    journey = travel(robot, place)
    assert (journey.done, journey.failure, robot.bumps) == (True, None, 0)


def test_faces_as_the_place_says():
    robot = SimulatedRobot(HOUSE)
    travel(robot, "kitchen")
    assert robot.pose.heading == pytest.approx(90, abs=1.5)


def test_names_do_not_care_about_case_and_must_be_known():
    robot = SimulatedRobot(HOUSE)
    assert robot.locate("ALICE") == (3.3, 7.2)
    with pytest.raises(RobotError, match="I don't know where 'moon' is"):
        robot.navigate_to("moon")


def test_a_walled_in_place_has_no_way():
    world = World(
        start=Pose(0, 0),
        walls=(((3.0, -1.0), (5.0, -1.0), (5.0, 1.0), (3.0, 1.0), (3.0, -1.0)),),
        places=(Place("cell", 4, 0),),
    )
    journey = SimulatedRobot(world).navigate_to("cell")
    assert (journey.done, journey.failure) == (True, "there is no free way to the cell")


def test_a_person_on_the_place_leaves_no_way_until_they_move():
    robot = SimulatedRobot(World(start=Pose(0, 0), places=(Place("x", 3, 0),), people=(Person("Bob", 3.0, 0.1, 0.25),)))
    assert travel(robot, "x").failure == "there is no free way to the x"
    robot.move_thing("Bob", 3.0, 2.0)
    assert travel(robot, "x").failure is None


def test_plans_anew_when_somebody_steps_in_the_way():
    world = World(
        start=Pose(0, 0),
        places=(Place("end", 6, 0),),
        people=(Person("Bob", 3, 3, 0.25),),
        boxes=(FurnitureBox(3, -5, 1, 1),),
    )
    robot = SimulatedRobot(world)
    journey = robot.navigate_to("end")
    for _ in range(40):
        robot.step(0.05)
    robot.move_thing("Bob", 3.0, 0.0)
    for _ in range(600):
        robot.step(0.05)
    assert (journey.done, journey.failure, robot.bumps) == (True, None, 0)


def test_a_blocked_place_is_free_again_later():
    robot = SimulatedRobot(load_world(WORLDS / "locked_lab.toml"))
    assert travel(robot, "lab").failure == "there is no free way to the lab"
    robot.step(22)
    assert travel(robot, "lab").failure is None


def test_a_way_that_is_blocked_while_driving():
    robot = SimulatedRobot(HOUSE.replace(faults=(WorldFault("blocked", start=3.0, place="lab"),)))
    assert travel(robot, "lab").failure == "there is no free way to the lab"
    assert robot.time == pytest.approx(3.0, abs=0.1)


def test_no_grip_on_the_way():
    robot = SimulatedRobot(HOUSE.replace(faults=(WorldFault("slip", start=2.0, grip=0.0),)))
    assert travel(robot, "lab").failure == "stuck on the way to the lab: the wheels turn but the robot doesn't move"


def test_an_uneven_grip_does_not_matter():
    robot = SimulatedRobot(HOUSE.replace(faults=(WorldFault("slip", wheel="left", grip=0.7),)))
    assert travel(robot, "lab").failure is None


def test_an_empty_battery_on_the_way():
    robot = SimulatedRobot(HOUSE.replace(battery=0.2))
    assert travel(robot, "lab").failure == "the battery is empty"
    assert robot.navigate_to("lab").failure == "the battery is empty"


def test_cancel_and_stop_brake():
    for end in ("cancel", "stop", "drive", "elsewhere"):
        robot = SimulatedRobot(HOUSE)
        journey = robot.navigate_to("office")
        robot.step(3)
        if end == "cancel":
            journey.cancel()
        elif end == "stop":
            robot.stop()
            assert journey.failure == "the robot was stopped"
        elif end == "drive":
            robot.drive(0.0, 0.0)
        else:
            robot.navigate_to("lab").cancel()
        assert journey.done
        assert journey.failure is not None
        robot.step(0.5)
        assert not robot.moving


def test_the_same_journey_twice():
    def poses():
        robot = SimulatedRobot(HOUSE)
        journey = robot.navigate_to("office")
        found = []
        while not journey.done:
            robot.step(0.05)
            found.append(robot.pose)
        return found

    assert poses() == poses()


def to_pose(robot, pose, seconds=60):
    journey = robot.navigate_to_pose(pose)
    for _ in range(seconds * 20):
        if journey.done:
            break
        robot.step(0.05)
    return journey


def test_a_pose_is_reached_facing_as_it_does():
    robot = SimulatedRobot(HOUSE)
    journey = to_pose(robot, Pose(3.0, 2.0, -90.0))
    assert (journey.done, journey.failure) == (True, None)
    assert robot.pose.distance_to((3.0, 2.0)) < 0.05
    assert robot.pose.heading == pytest.approx(-90, abs=1.5)
    assert journey.left == pytest.approx(0, abs=0.05)


@pytest.mark.parametrize("x", [100.0, float("inf"), float("nan")])
def test_a_pose_without_a_way(x):
    robot = SimulatedRobot(HOUSE)
    assert to_pose(robot, Pose(x, 2.0)).failure == f"there is no free way to ({x:.2f}, 2.00)"


def test_a_pose_on_a_place_is_that_place():
    place = HOUSE.places[0]
    robot = SimulatedRobot(HOUSE.replace(faults=(WorldFault("blocked", place=place.name),)))
    assert to_pose(robot, Pose(place.x, place.y)).failure == f"there is no free way to the {place.name}"


def test_a_pose_on_a_thing_is_reached_to_arms_length():
    thing = HOUSE.objects[0]
    robot = SimulatedRobot(HOUSE)
    assert to_pose(robot, Pose(thing.x, thing.y)).failure is None
    assert abs(robot.pose.bearing_to((thing.x, thing.y))) < 2


@settings(max_examples=15, deadline=None)
@given(st.floats(0.05, 1.5), st.sampled_from([0.1, 0.2]))
def test_the_room_beside_walls_is_exact_as_far_as_it_is_needed(within, size):
    grid, obstacles = ClearanceGrid(HOUSE, size), Obstacles(HOUSE)
    near, exact = grid.clearance(obstacles, within), grid.clearance(obstacles, 100.0)
    assert (near[exact <= within] == exact[exact <= within]).all()
    assert (near[exact > within] > within).all()

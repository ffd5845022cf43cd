"""Conditions, and the robot that roams on one of them."""

from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from btlang.actions import motion, sensing
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Pose
from btlang.robots.worlds.world import Door, FurnitureBox, Person, Place, WorldFault, WorldObject
from btlang.robots.worlds.world_file import load_world

ROOM = Path(__file__).parents[2] / "examples" / "worlds" / "walled_room.toml"


@pytest.mark.parametrize("seconds", [60, 600])
def test_roams_without_a_bump(bench, seconds):
    b = bench(load_world(ROOM))
    seen = set()
    while b.clock.now < seconds:
        if sensing.wall_in_front(b.robot):
            b.run(motion.turn_left, angle=90.0)
        else:
            b.run(motion.move_forward, distance=0.5)
        seen.add((round(b.robot.pose.x), round(b.robot.pose.y)))
    assert b.robot.bumps == 0
    assert len(seen) > 8


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(x=st.floats(0.21, 5.79), y=st.floats(0.21, 5.79), heading=st.floats(-180, 180))
def test_half_a_metre_is_free_where_no_wall_is_in_front(bench, x, y, heading):
    world = load_world(ROOM)
    b = bench(world, start=Pose(x, y, heading))
    assume(b.robot._obstacles.nearest(x, y)[0] > 0.201)
    assume(not any(box.contains((x, y)) for box in world.boxes))
    free = sensing.distance_ahead(b.robot)
    way = ((x + gone * cos(radians(heading)), y + gone * sin(radians(heading))) for gone in np.linspace(0.0, 0.5, 51))
    gaps = [b.robot._obstacles.nearest(*point)[0] - b.robot.body.radius for point in way]
    assume(not any(abs(gap) < 1e-9 for gap in gaps))  # it neither touches a wall beside it nor passes it
    if sensing.wall_in_front(b.robot):
        with pytest.raises(ActionFailed, match="scanner: "):
            b.run(motion.move_forward, distance=free + 0.05)
    else:
        assert free > 0.5
        b.run(motion.move_forward, distance=0.5)


def test_each_side(bench):
    walls = (((0.6, -0.1), (0.6, 0.1)), ((-0.1, -0.7), (0.1, -0.7)))
    b = bench(walls=walls)
    assert sensing.wall_in_front(b.robot)
    assert not sensing.path_is_clear(b.robot)
    assert sensing.wall_on_right(b.robot)
    assert not sensing.wall_on_left(b.robot)
    assert not sensing.wall_behind(b.robot)
    b = bench(walls=walls, start=Pose(0.0, 0.0, 90.0))
    assert not sensing.wall_in_front(b.robot)
    assert sensing.wall_on_right(b.robot)
    assert sensing.wall_behind(b.robot)


def test_passes_doors_that_are_wide_enough(bench):
    b = bench(boxes=(FurnitureBox(0.8, 0.6, 0.5, 0.5), FurnitureBox(0.8, -0.6, 0.5, 0.5)))
    assert sensing.path_is_clear(b.robot)
    b = bench(boxes=(FurnitureBox(0.8, 0.45, 0.5, 0.5),))
    assert not sensing.path_is_clear(b.robot)


def test_distance_ahead(bench):
    b = bench(walls=(((2.0, -1.0), (2.0, 1.0)),), people=(Person("A", -2.0, 0.0, 0.25),))
    assert sensing.distance_ahead(b.robot) == pytest.approx(1.8, abs=0.01)
    b.run(motion.turn_around)
    assert sensing.distance_ahead(b.robot) == pytest.approx(1.55, abs=0.02)
    b.run(motion.turn_left, angle=90.0)
    assert sensing.distance_ahead(b.robot) == float("inf")


def test_what_a_silent_scanner_does_not_see_counts_as_blocked(bench):
    b = bench(faults=(WorldFault("silent scanner"),))
    assert sensing.wall_in_front(b.robot)
    assert sensing.wall_behind(b.robot)
    assert not sensing.path_is_clear(b.robot)
    with pytest.raises(ActionFailed, match=r"^the laser scanner is silent$"):
        sensing.distance_ahead(b.robot)


def test_the_rest(bench, table):
    b = bench(table, places=(Place("x", 0.4, 0.2), Place("y", 2.0, 2.0)), start=Pose(0.0, 0.0, 180.0))
    assert sensing.at_place(b.robot, "x")
    assert not sensing.at_place(b.robot, "y")
    assert not sensing.person_near(b.robot, "Alice")
    assert not sensing.someone_near(b.robot)
    b.robot.move_thing("Alice", 0.0, 1.0)
    assert sensing.someone_near(b.robot)
    assert not sensing.bumped(b.robot)
    assert not sensing.stuck(b.robot)
    assert sensing.battery_level(b.robot) == 100.0
    assert not sensing.battery_low(b.robot)
    assert sensing.hand_empty(b.robot)
    assert not sensing.holding(b.robot, "cup")


def test_a_scan_is_computed_once_for_all_who_ask_until_the_robot_moves(bench, monkeypatch):
    computed, points = [], sensing._points
    monkeypatch.setattr(sensing, "_points", lambda *given: computed.append(given[2]) or points(*given))
    b = bench(load_world(ROOM))
    for _ in range(3):
        assert sensing.path_is_clear(b.robot) == (not sensing.wall_in_front(b.robot))
        sensing.wall_on_left(b.robot)
        sensing.distance_ahead(b.robot)
    assert computed == [0.0, 90.0, 0.0]  # the way ahead for two questions
    b.robot.drive(0.2, 0.0)
    b.tick()
    sensing.path_is_clear(b.robot)
    assert computed == [0.0, 90.0, 0.0, 0.0]


def test_nothing_is_kept_of_a_scan_that_may_be_overwritten(bench):
    b = bench()
    scan = np.full(360, np.inf)
    b.robot._scan = lambda pose: scan
    assert sensing.path_is_clear(b.robot)
    scan[:] = 0.3
    assert sensing.wall_in_front(b.robot)


def test_who_and_what_is_near_a_place_or_at_a_door(bench):
    door = Door("gate", (4.0, 0.0), (4.0, 1.0))
    people = (Person("Ann", 4.5, 1.0, 0.25), Person("Bob", 1.0, 4.0, 0.25))
    b = bench(
        doors=(door,), people=people, objects=(WorldObject("mug", 1.0, 3.0, 0.04),), places=(Place("Desk", 1.0, 3.5),)
    )
    assert sensing.someone_at_door(b.robot, "gate")
    assert sensing.person_at_door(b.robot, "Ann", "gate")
    assert not sensing.person_at_door(b.robot, "Bob", "gate")
    assert sensing.someone_near_place(b.robot, "Desk")
    assert sensing.person_near_place(b.robot, "Bob", "Desk")
    assert not sensing.person_near_place(b.robot, "Ann", "Desk")
    assert sensing.object_near_place(b.robot, "mug", "Desk")


def test_names_are_those_of_the_present_mission(bench):
    b = bench(people=(Person("Ann", 1.0, 0.0, 0.25),))
    b.robot.name_places([Place("Desk", 1.0, 1.0)])
    assert sensing.distance_to_place(b.robot, "desk") == pytest.approx(2**0.5)
    assert sensing.place_of_robot(b.robot) == "Desk"
    assert sensing.person_is_at(b.robot, "Ann", "desk")
    b.robot.name_places([Place("DESK", 3.0, 0.0)])
    assert sensing.distance_to_place(b.robot, "desk") == 3.0
    assert sensing.place_of_robot(b.robot) == "DESK"
    assert sensing.person_is_at(b.robot, "Ann", "desk")
    b.robot.name_places([])
    with pytest.raises(ActionFailed, match="don't know where 'desk' is"):
        sensing.at_place(b.robot, "desk")

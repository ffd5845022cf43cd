"""Zones to keep out of and to drive slowly through; doors, and what can be switched."""

from __future__ import annotations

from collections import Counter
from random import Random

import pytest

from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.regions import edge_distance
from btlang.robots.robot import RobotError
from tests.profiles import amount
from tests.world.test_people import Life
from tests.world.worlds import museum, rooms

STAIRS = '[[zones]]\nname = "stairs"\nkind = "keep out"\npoints = [[6, 1], [8, 1], [8, 3], [6, 3]]\n'
DOOR = '[[doors]]\nname = "gate"\nfrom = [5, 1.5]\nto = [5, 2.5]\nopen = false\n'


def test_a_way_leads_around_a_closed_zone_and_a_goal_inside_is_refused() -> None:
    life = Life(rooms(STAIRS))
    goal = life.robot.navigate_to("east")
    zone = life.robot.world.zones[0]
    while not goal.done:
        life.robot.step(0.05)
        pose = life.robot.pose
        assert edge_distance(zone, (pose.x, pose.y)) >= life.robot.radius
    assert goal.failure is None
    goal = life.robot.navigate_to_pose(Pose(7, 2))
    assert goal.failure == "(7.00, 2.00) is in the stairs, where the robot may not go"


def test_whatever_drives_it_stands_before_a_closed_zone() -> None:
    life = Life(rooms(STAIRS))
    life.robot.put(Pose(5.4, 2, 0))
    life.robot.drive(1.0, 0.0)
    life.after(4)
    assert 5.7 < life.robot.pose.x <= 5.8
    assert not life.robot.stuck
    life.robot.drive(-0.5, 0.0)
    life.after(1)
    assert life.robot.pose.x < 5.5  # away from it it may drive


def test_a_slow_zone_slows_whatever_drives() -> None:
    life = Life(rooms(STAIRS.replace('"keep out"', '"slow"\nspeed = 0.2')))
    life.robot.put(Pose(5, 2, 0))
    life.robot.drive(0.8, 0.0)
    speeds = []
    for _ in range(100):
        life.robot.step(0.05)
        speeds.append((life.robot.pose.x, life.robot.velocity[0]))
    assert max(speed for x, speed in speeds if x < 5.7) > 0.6
    assert max(speed for x, speed in speeds if 6.2 < x < 7.8) == pytest.approx(0.2)


def test_a_mission_closes_and_opens_zones() -> None:
    life = Life(rooms(STAIRS.replace('"keep out"', '"slow"\nspeed = 0.2')))
    life.robot.zones.close("Stairs")
    assert life.robot.navigate_to_pose(Pose(7, 2)).failure is not None
    life.robot.zones.open("stairs")
    assert life.robot.navigate_to_pose(Pose(7, 2)).failure is None
    life.robot.zones.close("stairs")
    life.robot.seed_choices(2)  # the next run begins
    assert not life.robot.zones.is_closed("stairs")


def test_a_door_is_a_wall_until_it_is_opened() -> None:
    life = Life(rooms(DOOR))
    assert life.robot.navigate_to("east").failure == "there is no free way to the east"
    with pytest.raises(RobotError, match=r"the gate is 4\.0 m away"):
        life.robot.move_door("gate", True)
    before = life.robot.beside_door("gate")[0]
    assert (before.x, before.y) == pytest.approx((4.3, 2))
    life.robot.put(before)
    life.robot.move_door("gate", True)
    goal = life.robot.navigate_to("east")
    life.until(lambda: goal.done, 30)
    assert goal.failure is None
    life.robot.put(Pose(5, 2))
    with pytest.raises(RobotError, match="something is in the gate"):
        life.robot.move_door("gate", False)


def test_switches() -> None:
    lamp = 'objects = [{ name = "lamp", x = 2, y = 2, switch = "on" }, { name = "cup", x = 1.3, y = 2 }]\n'
    life = Life(rooms(more=lamp))
    assert life.robot.is_on("lamp")
    life.robot.switch("lamp", None)
    assert not life.robot.is_on("lamp")
    with pytest.raises(RobotError, match="the cup can't be switched on or off"):
        life.robot.switch("cup", True)
    with pytest.raises(RobotError, match="the lamp is fixed"):
        life.robot.grasp("right", "lamp")


@pytest.mark.long
def test_random_journeys_among_people_and_zones() -> None:
    """No contact while the robot moves, no entry into a zone, and every goal is reached or refused with a reason."""
    random = Random(7)
    life = Life(museum(5), 7)
    robot = life.robot
    closed = [zone for zone in robot.world.zones if zone.is_closed]
    names = [thing.name for thing in (*robot.world.places, *robot.world.people)]
    ends: Counter[str] = Counter()
    for _ in range(amount(25, 1000)):
        pose = Pose(random.uniform(0.5, 19.5), random.uniform(0.5, 13.5), random.uniform(-180, 180))
        goal = robot.navigate_to(random.choice(names)) if random.random() < 0.5 else robot.navigate_to_pose(pose)
        begun = robot.time
        while not goal.done:
            robot.power.set_level(100)
            robot.step(0.05)
            here = robot.pose
            assert robot.time - begun < 300, goal.name
            assert all(edge_distance(zone, (here.x, here.y)) > robot.radius - 1e-3 for zone in closed)
            if robot.velocity[0]:
                gap = robot._obstacles.nearest_walking(here.x, here.y)[0]
                assert gap > robot.radius - 1e-3, (robot.time, goal.name)
        ends["" if goal.failure is None else goal.failure.split()[0]] += 1
    assert robot.bumps == 0
    assert ends[""] > 0.6 * ends.total()

"""Hands, joints, voice, and the emergency stop from another thread."""

import threading

import pytest

from btlang.robots.geometry import Pose
from btlang.robots.robot import Robot, RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import Person, World, WorldFault, WorldObject

TABLE = World(
    start=Pose(0, 0),
    objects=(WorldObject("cup", 0.4, 0.0, 0.04), WorldObject("book", 0.35, 0.3, 0.05), WorldObject("ball", 3, 0, 0.1)),
)


def test_it_is_a_robot():
    robot: Robot = SimulatedRobot(TABLE)
    assert robot.radius == 0.2


def test_grasps_the_nearest_carries_and_puts_down():
    robot = SimulatedRobot(TABLE)
    assert robot.grasp("right").done
    assert robot.holding("right") == "cup"
    with pytest.raises(RobotError, match="the right hand already holds the cup"):
        robot.grasp("right")
    robot.grasp("left")
    assert robot.holding("left") == "book"
    robot.drive(0.5, 45)
    robot.step(2)
    assert robot.locate("cup") == (robot.pose.x, robot.pose.y)
    robot.release("right")
    assert 0.24 < robot.pose.distance_to(robot.locate("cup")) < 0.5
    assert robot.holding("right") is None
    robot.release("right")  # an empty hand
    assert robot.bumps == 0


def test_nothing_within_reach():
    robot = SimulatedRobot(TABLE)
    with pytest.raises(RobotError, match="the ball is not within reach of the right hand"):
        robot.grasp("right", "ball")
    robot = SimulatedRobot(TABLE.replace(start=Pose(0, 0, 180)))
    with pytest.raises(RobotError, match="nothing is within reach of the left hand"):
        robot.grasp("left")


def test_walls_are_out_of_reach_through():
    robot = SimulatedRobot(TABLE.replace(walls=(((0.3, -1.0), (0.3, 1.0)),)))
    with pytest.raises(RobotError, match="nothing"):
        robot.grasp("right")
    free = SimulatedRobot(TABLE)
    free.grasp("right", "cup")


def test_puts_down_where_no_wall_is():
    robot = SimulatedRobot(TABLE.replace(walls=(((1.0, -1.0), (1.0, 1.0)),)))
    robot.grasp("right", "cup")
    robot.drive(0.3, 0)
    robot.step(5)
    robot.release("right")
    assert robot.locate("cup")[0] < 1.0
    assert robot.pose.distance_to(robot.locate("cup")) > 0.24


def test_a_weak_hand_drops():
    events = []
    world = TABLE.replace(faults=(WorldFault("weak hand", seconds=2.0),))
    robot = SimulatedRobot(world, lambda kind, data: events.append((kind, dict(data))))
    robot.grasp("right")
    robot.step(1.9)
    assert robot.holding("right") == "cup"
    robot.step(0.2)
    assert robot.holding("right") is None
    assert events[-1] == ("drop", {"hand": "right", "name": "cup"})


def test_faults_are_told():
    events = []
    world = TABLE.replace(
        faults=(WorldFault("slip", start=1.0, wheel="left", grip=0.5), WorldFault("silent scanner", start=2.0))
    )
    robot = SimulatedRobot(world, lambda kind, data: events.append(data.get("text")))
    robot.step(3)
    assert events == ["the left wheel slips: 50% grip", "the laser scanner is silent"]


def test_joints_move_at_a_limited_rate_and_freeze():
    robot = SimulatedRobot(TABLE)
    robot.move_joints({"right arm lift": 120.0, "head turn": 500.0})
    robot.step(0.5)
    assert robot.joint("right arm lift") == pytest.approx(60.0)
    assert robot.moving
    robot.freeze_joints("right arm lift")
    assert robot.joints_at_target("right arm lift")
    assert not robot.joints_at_target("head turn")
    robot.step(1)
    assert robot.joint("right arm lift") == pytest.approx(60.0)
    assert robot.joint("head turn") == 90.0
    assert not robot.moving


def test_unknown_joints():
    robot = SimulatedRobot(TABLE)
    with pytest.raises(RobotError, match='no joint "tail"'):
        robot.move_joints({"tail": 1.0})
    with pytest.raises(RobotError, match='no joint "tail"'):
        robot.joint("tail")


def test_speech_takes_time_and_printing_none():
    events = []
    robot = SimulatedRobot(TABLE, lambda kind, data: events.append((kind, data.get("text"))))
    robot.say("hello")
    robot.print("now")
    assert robot.speaking
    robot.step(0.6)
    assert robot.speaking
    robot.step(0.1)
    assert not robot.speaking
    robot.say("a long sentence")
    robot.silence()
    assert not robot.speaking
    assert events == [("say", "hello"), ("print", "now"), ("say", "a long sentence")]


def test_people_nearby():
    robot = SimulatedRobot(
        World(start=Pose(0, 0), people=(Person("A", 2, 0, 0.25), Person("B", 1, 0, 0.25), Person("C", 9, 0, 0.25)))
    )
    assert robot.nearby_people(3) == ["B", "A"]


def test_carried_things_and_places_cannot_be_moved():
    robot = SimulatedRobot(TABLE)
    robot.grasp("right", "cup")
    with pytest.raises(RobotError, match="the cup can't be moved"):
        robot.move_thing("cup", 1, 1)


def test_stop_freezes_everything_and_outlasts_the_tick_in_flight():
    robot = SimulatedRobot(TABLE.replace(start=Pose(0, 5)))
    robot.drive(1.0, 30.0)
    robot.move_joints({"right arm lift": 90.0})
    robot.say("a very long sentence indeed")
    robot.step(1)
    lift = robot.joint("right arm lift")
    stopper = threading.Thread(target=robot.stop)
    stopper.start()
    stopper.join()
    robot.drive(1.0, 0.0)  # the tick in flight does not know yet
    robot.move_joints({"right arm lift": 0.0})
    assert robot.navigate_to("ball").failure == "the robot was stopped"
    robot.step(0.3)
    assert not robot.moving
    assert not robot.speaking
    assert robot.joint("right arm lift") == lift
    assert robot.stops == 1
    robot.drive(0.5, 0.0)  # afterwards it obeys again
    robot.step(1)
    assert robot.moving

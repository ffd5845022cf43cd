"""Driving, joints, sensors, services, speech and parameters that keyword files declare."""

from __future__ import annotations

import math

from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from tests.ros.declared import Robot, robot, words

__all__ = ["robot"]

DRIVE = words("drive")
SENSES = words("senses")
DEEDS = words("deeds")


def test_drives_a_distance_and_turns(robot: Robot) -> None:
    peer = robot.peer("robot", "drive")
    assert robot.run("move forward 0.6 m at 0.8 m/s then turn right", DRIVE) == ""
    x = float(peer.expect("zero").split()[1])
    assert math.isclose(x, 0.6, abs_tol=0.03)
    assert abs(float(peer.expect("zero").split()[2]) + 90) <= 2


def test_drives_with_stamped_velocities(robot: Robot) -> None:
    peer = robot.peer("robot", "stamped")
    assert robot.run("move forward 0.3 m at 1 m/s", DRIVE.replace("/Twist", "/TwistStamped")) == ""
    assert peer.expect("zero").startswith("zero 0.")


def test_halting_a_drive_stops_the_robot(robot: Robot) -> None:
    peer = robot.peer("robot", "drive")
    engine = robot.load("move forward 5 m", DRIVE)
    ticks = iter(range(60))
    assert robot.tick(lambda: next(ticks) == 50) == RUNNING
    engine.halt()
    assert 0 < float(peer.expect("zero").split()[1]) < 1


def test_a_robot_that_does_not_move(robot: Robot) -> None:
    peer = robot.peer("robot", "stuck")
    assert robot.run("move forward 1 m", DRIVE) == "the robot makes no progress: 0.00 of 1.00 m done"
    peer.expect("zero")


def test_odometry_that_falls_silent(robot: Robot) -> None:
    peer = robot.peer("robot", "drive")
    engine = robot.load("move forward 5 m", DRIVE)
    ticks = iter(range(60))
    robot.tick(lambda: next(ticks) == 40)
    peer.kill()
    robot.tick(lambda: False)
    assert engine.failure is not None
    assert engine.failure.reason.startswith(_silent("/odom"))


def test_nobody_gives_odometry(robot: Robot) -> None:
    assert robot.run("move forward 5 m", DRIVE) == "nobody publishes /odom"


def test_senses(robot: Robot) -> None:
    robot.peer("robot", "battery", "scan", "services")
    robot.load("check battery is above 1%; check charging; check wall ahead; check wall at 50%; check docked", SENSES)
    assert robot.clients.wait(10.0) == []
    for condition in ("battery is below 26%", "battery is at least 25%", "charging", "wall ahead", "docked"):
        assert robot.run(f"check {condition}", SENSES) == ""
    assert robot.run("check wall at 25%", SENSES) == ""
    assert robot.run("check the room on the right is above 100 m", SENSES) == ""
    assert robot.run("check wall at 10%", SENSES) == "ranges of /scan is 0.2"
    assert robot.run("check the battery is above 30%", SENSES) == "battery is 25%"


def _silent(topic: str) -> tuple[str, str]:
    """How the reasons begin when a publisher was killed: DDS may notice that before the last reading is too old."""
    return f"nobody publishes {topic}", f"nothing has arrived on {topic} for "


def test_a_topic_that_falls_silent(robot: Robot) -> None:
    peer = robot.peer("robot", "battery")
    robot.load("check battery is below 26%", SENSES)
    assert robot.clients.wait(10.0) == []
    robot.load("repeat until not battery is below 26%: wait 0.1 s", SENSES)
    peer.kill()
    assert robot.tick(lambda: False) == FAILURE  # what is not known is not false, so "not" does not make it true
    robot.wait_for(lambda: robot.run("check battery is below 26%", SENSES) != "")  # readings may still be on their way
    assert robot.run("check battery is below 26%", SENSES).startswith(_silent("/battery_state"))


def test_a_topic_of_another_type(robot: Robot) -> None:
    robot.peer("robot", "scan")
    text = SENSES.replace('"/battery_state"', '"/scan"')
    reason = "the topic /scan is of the type sensor_msgs/msg/LaserScan, not sensor_msgs/msg/BatteryState"
    robot.load("check charging", text)
    robot.wait_for(lambda: robot.clients.missing() == [reason])
    assert robot.run("check charging", text) == reason


def test_speech(robot: Robot) -> None:
    peer = robot.peer("robot", "speech")
    assert robot.run('say "good day" then hum for 0.5 s', DEEDS) == ""
    assert peer.expect("said") == "said I say: good day"
    peer.expect("said silence")
    assert 4 <= peer.told.count("said hm") <= 6


def test_nobody_listens(robot: Robot) -> None:
    assert robot.run("say hello", DEEDS) == "nobody listens to /speech"


def test_a_listener_of_another_type(robot: Robot) -> None:
    robot.peer("robot", "speech")
    text = DEEDS.replace("std_msgs/msg/String", "std_msgs/msg/Bool").replace('data = "I say: {text}"', "data = true")
    text = text.replace('data = "hm"', "data = true").replace('data = "silence"', "data = false")
    assert robot.run("say hello", text) == (
        "the topic /speech is of the type std_msgs/msg/String, not std_msgs/msg/Bool"
    )


def test_needs(robot: Robot) -> None:
    robot.load("dock then say hello then check robot is careful", DEEDS)
    assert [(need.kind, need.name, need.type, need.missing) for need in robot.clients.needs()] == [
        ("listener", "/speech", "std_msgs/msg/String", "nobody listens to /speech"),
        ("node", "/robot", "max_speed", "there is no node /robot"),
        ("service", "/dock", "std_srvs/srv/Trigger", "there is no service server /dock"),
    ]
    robot.peer("robot", "services", "speech")
    assert robot.clients.wait(10.0) == []


def test_services(robot: Robot) -> None:
    peer = robot.peer("robot", "services")
    assert robot.run("close the left hand", DEEDS) == ""
    assert peer.expect("hand") == "hand True"
    assert robot.run("dock", DEEDS) == "the dock is taken"


def test_a_service_that_is_not_there(robot: Robot) -> None:
    assert robot.run("dock", DEEDS) == "there is no service server /dock"


def test_a_service_of_another_type(robot: Robot) -> None:
    robot.peer("robot", "services")
    assert robot.run("dock", DEEDS.replace("Trigger", "SetBool")) == (
        "the service /dock is of the type std_srvs/srv/Trigger, not std_srvs/srv/SetBool"
    )


def test_a_service_that_does_not_answer(robot: Robot) -> None:
    peer = robot.peer("robot", "services")
    text = DEEDS.replace('"/think"', '"/think", limit = 0.5')
    assert robot.run("think", text) == "/think has not answered within 0.5 s"
    engine = robot.load("think", DEEDS)
    robot.tick(lambda: peer.has_told("thinking"))
    peer.kill()
    robot.tick(lambda: False)
    assert engine.failure is not None
    assert engine.failure.reason == "the server of /think is gone"


def test_joints(robot: Robot) -> None:
    peer = robot.peer("robot", "arm")
    assert robot.run("raise left arm", DEEDS) == ""
    assert peer.expect("joint") == "joint left_arm_lift 1.20 0 500000000"
    text = DEEDS.replace("= 1.2", "= 9").replace("left_arm_lift", "other")
    engine = robot.load("raise left arm", text)
    assert robot.tick(lambda: peer.has_told("joint")) in (RUNNING, SUCCESS)
    engine.halt()


def test_a_joint_that_is_not_there(robot: Robot) -> None:
    robot.peer("robot", "arm")
    text = DEEDS.replace("left_arm_lift", "tail")
    assert robot.run("raise left arm", text) == '/joint_states doesn\'t report the joint "tail"'


def test_parameters(robot: Robot) -> None:
    robot.peer("robot")
    robot.load("check robot is careful", DEEDS)
    assert robot.clients.wait(10.0) == []
    assert robot.run("check robot is careful", DEEDS) == "max_speed of /robot is 0.5"
    assert robot.run("limit speed to 0.25 m/s then wait until the robot is careful", DEEDS) == ""
    assert robot.run("check the speed limit is below 0.3 m/s", DEEDS) == ""


def test_a_parameter_of_nobody(robot: Robot) -> None:
    assert robot.run("check robot is careful", DEEDS) == "there is no node /robot"
    robot.peer("robot")
    text = DEEDS.replace("max_speed", "min_speed")
    assert robot.run("limit speed to 0.25 m/s", text).startswith("Invalid access to undeclared parameter")

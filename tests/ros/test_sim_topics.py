"""`btc sim-ros` in another process: every topic and service of docs/ros.md, as a user's program sees them."""

from __future__ import annotations

import re
import threading
from itertools import pairwise
from math import degrees, pi, radians

import numpy as np
import pytest
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, JointState, LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world_file import load_world
from tests.ros.client import LATCHED, Client
from tests.ros.processes import REPOSITORY, ROOM, wait_until


def seconds(stamp) -> float:
    return stamp.sec + stamp.nanosec * 1e-9


def twist(linear: float, angular: float = 0.0) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


def stands(odometry: Odometry) -> bool:
    return (odometry.twist.twist.linear.x, odometry.twist.twist.angular.z) == (0.0, 0.0)


def test_the_clock_never_goes_back_and_stamps_are_of_it(sim, client: Client):
    clock = client.hear(Clock, "/clock")
    odometry = client.hear(Odometry, "/odom")
    clock.wait(lambda _: len(clock.messages) >= 100)
    times = [seconds(message.clock) for message in clock.messages]
    assert times[0] > 0
    assert times == sorted(times)
    assert min(b - a for a, b in pairwise(times)) == pytest.approx(0.05)
    assert times[0] - 1 < seconds(odometry.messages[-1].header.stamp) <= seconds(clock.next().clock)


def test_one_command_moves_it_and_silence_brakes(start_sim, client: Client):
    start_sim("--speed", "5")
    odometry = client.hear(Odometry, "/odom")
    start = odometry.wait().pose.pose
    assert (start.position.x, start.position.y) == (1.0, 2.0)
    assert start.orientation.z == pytest.approx(0.5**0.5)
    client.publisher(Twist, "/cmd_vel").publish(twist(0.4))
    odometry.wait(lambda message: message.twist.twist.linear.x > 0.2)
    end = odometry.wait(stands)
    assert (end.header.frame_id, end.child_frame_id) == ("odom", "base_link")
    assert end.pose.pose.position.x == pytest.approx(1.0)
    assert 2.1 < end.pose.pose.position.y < 2.4
    moved = [message for message in odometry.messages if not stands(message)]
    assert 0.5 < seconds(moved[-1].header.stamp) - seconds(moved[0].header.stamp) < 1.0


def test_it_turns_left_for_positive_rates(start_sim, client: Client):
    start_sim("--speed", "5")
    odometry = client.hear(Odometry, "/odom")
    odometry.wait()
    client.publisher(Twist, "/cmd_vel").publish(twist(0.0, 1.0))
    turning = odometry.wait(lambda message: message.twist.twist.angular.z > 0.9)
    assert turning.twist.twist.angular.z == pytest.approx(1.0)
    end = odometry.wait(stands).pose.pose.orientation
    assert pi / 2 + 0.2 < 2 * np.arctan2(end.z, end.w) < pi


def test_a_zero_brakes_at_once_and_no_number_is_ignored(start_sim, client: Client):
    start_sim("--speed", "5")
    odometry = client.hear(Odometry, "/odom")
    odometry.wait()
    wheels = client.publisher(Twist, "/cmd_vel")
    wheels.publish(twist(float("nan")))
    wheels.publish(twist(0.2))
    odometry.wait(lambda message: message.twist.twist.linear.x > 0.0)
    wheels.publish(twist(0.0))
    odometry.wait(stands)


def test_while_commands_come_it_drives_until_it_bumps(start_sim, client: Client):
    start_sim("--speed", "5")
    bumps = client.hear(String, "/bump")
    pose = client.hear(PoseWithCovarianceStamped, "/amcl_pose", LATCHED)
    wheels = client.publisher(Twist, "/cmd_vel")
    pose.wait()
    while not bumps.messages and len(pose.messages) < 200:
        wheels.publish(twist(0.6))
        pose.next()
    assert [message.data for message in bumps.messages] == ["a wall"]
    at = pose.wait(lambda message: message.pose.pose.position.y > 3.79)  # it may come after what it led to
    assert at.pose.pose.position.y == pytest.approx(3.8, abs=0.01)
    assert at.header.frame_id == "map"


def test_the_scan_is_that_of_the_simulated_robot(sim, client: Client):
    scan = client.hear(LaserScan, "/scan", qos_profile_sensor_data).wait()
    assert np.allclose(scan.ranges, SimulatedRobot(load_world(ROOM)).scan(), atol=1e-5)
    assert (scan.angle_min, scan.header.frame_id) == (0.0, "base_link")
    assert (degrees(scan.angle_increment), degrees(scan.angle_max)) == pytest.approx((1, 359))


def test_battery_and_dock(sim, client: Client):
    battery = client.hear(BatteryState, "/battery_state")
    docked = client.hear(Bool, "/docked", LATCHED)
    assert battery.wait().percentage == pytest.approx(0.5, abs=0.01)
    assert battery.messages[0].power_supply_status == BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
    assert docked.wait().data is False
    assert client.call(Trigger, "/dock").success
    docked.wait(lambda message: message.data)
    battery.wait(lambda message: message.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_CHARGING)
    battery.wait(lambda message: message.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_FULL)
    assert client.call(Trigger, "/undock").success
    docked.wait(lambda message: not message.data)
    odometry = client.hear(Odometry, "/odom")
    client.publisher(Twist, "/cmd_vel").publish(twist(1.0))
    odometry.wait(lambda message: message.pose.pose.position.y > 2.15 and stands(message))
    answer = client.call(Trigger, "/dock")
    assert not answer.success
    assert answer.message.startswith("the dock is 0.")


def test_joints_go_where_the_last_point_says_and_freeze_without_one(start_sim, client: Client):
    start_sim("--speed", "4")  # at 20 the joint may be there before a busy machine freezes it
    states = client.hear(JointState, "/joint_states")
    names = list(states.wait().name)
    assert names[:3] + names[6:] == ["left_arm_lift", "left_arm_swing", "left_arm_bend", "head_turn", "head_tilt"]
    joints = client.publisher(JointTrajectory, "/joint_trajectory")

    def go(joint: str, *angles: float) -> None:
        points = [JointTrajectoryPoint(positions=[angle]) for angle in angles]
        joints.publish(JointTrajectory(joint_names=[joint], points=points))

    def at(message: JointState, joint: str) -> float:
        return message.position[names.index(joint)]

    go("head_turn", 0.2, -0.5)
    states.wait(lambda message: at(message, "head_turn") == pytest.approx(-0.5))
    go("tail", 1.0)
    go("left_arm_lift", radians(180))
    states.wait(lambda message: at(message, "left_arm_lift") > 0.1)
    joints.publish(JointTrajectory(joint_names=["left_arm_lift"]))
    while states.next().position != states.next().position:
        pass
    end = states.next()
    assert 0.1 < at(end, "left_arm_lift") < radians(180)
    assert at(end, "head_turn") == pytest.approx(-0.5)


def test_hands(sim, client: Client):
    holding = client.hear(String, "/left_hand/holding", LATCHED)
    assert holding.wait().data == ""
    wrong = client.call(SetBool, "/right_hand/close", data=True)
    assert (wrong.success, wrong.message) == (False, "nothing is within reach of the right hand")
    closed = client.call(SetBool, "/left_hand/close", data=True)
    assert (closed.success, closed.message) == (True, "cup")
    holding.wait(lambda message: message.data == "cup")
    again = client.call(SetBool, "/left_hand/close", data=True)
    assert (again.success, again.message) == (False, "the left hand already holds the cup")
    opened = client.call(SetBool, "/left_hand/close", data=False)
    assert (opened.success, opened.message) == (True, "cup")
    holding.wait(lambda message: message.data == "")
    assert client.call(SetBool, "/left_hand/close", data=False).success


def test_speech(start_sim, client: Client):
    sim = start_sim("--speed", "1")  # the topic keeps one message, which the next one must not replace unread
    speaking = client.hear(Bool, "/speaking", LATCHED)
    assert speaking.wait().data is False
    voice = client.publisher(String, "/speech")
    voice.publish(String(data="hello everybody"))
    speaking.wait(lambda message: message.data)
    speaking.wait(lambda message: not message.data)
    voice.publish(String(data="a long story " * 1000))
    speaking.wait(lambda message: message.data)
    voice.publish(String(data=""))
    speaking.wait(lambda message: not message.data)
    client.publisher(String, "/print").publish(String(data="42 %"))
    sim.wait_for('prints "42 %"')
    assert 'says "hello everybody"' in sim.out


def test_its_own_emergency_stop(start_sim, client: Client):
    start_sim("--speed", "0.5")  # slow, so that the arm is under way when it stops
    odometry = client.hear(Odometry, "/odom")
    speaking = client.hear(Bool, "/speaking", LATCHED)
    states = client.hear(JointState, "/joint_states")
    client.publisher(String, "/speech").publish(String(data="a long story " * 100))
    point = JointTrajectoryPoint(positions=[3.0])
    client.publisher(JointTrajectory, "/joint_trajectory").publish(
        JointTrajectory(joint_names=["left_arm_lift"], points=[point])
    )
    client.publisher(Twist, "/cmd_vel").publish(twist(0.5))
    odometry.wait(lambda message: message.twist.twist.linear.x > 0.1)
    speaking.wait(lambda message: message.data)
    assert client.call(Trigger, "/stop").success
    odometry.wait(stands)
    speaking.wait(lambda message: not message.data)
    arm = states.next().position[0]
    assert states.next().position[0] == arm < 3.0


def test_what_is_asked_for_after_a_stop_counts(sim, client: Client):
    voice = client.publisher(String, "/speech")
    for number in range(5):
        assert client.call(Trigger, "/stop").success
        voice.publish(String(data=f"number {number}"))
        sim.wait_for(f'says "number {number}"')


def test_namespace_and_the_time_of_the_system(start_sim, client: Client):
    start_sim("--namespace", "/robots/anna", "--no-clock")
    stamp = client.hear(Odometry, "/robots/anna/odom").wait().header.stamp
    assert abs(seconds(stamp) - client.node.get_clock().now().nanoseconds * 1e-9) < 5
    topics = dict(client.node.get_topic_names_and_types())
    assert "/clock" not in topics
    assert "/robots/anna/left_hand/holding" in topics


def test_two_clients_do_not_leave_threads(sim, client: Client):
    client.hear(Clock, "/clock").wait()
    before = threading.active_count()
    other = Client(client.node.context.get_domain_id())
    other.hear(Clock, "/clock").wait()
    other.close()
    other.close()
    assert threading.active_count() == before


def test_the_table_of_the_documentation_is_complete(nav2, run_mission, sim, client: Client):
    page = (REPOSITORY / "docs" / "ros.md").read_text(encoding="utf-8").partition("## Simulated robot over ROS 2")[2]
    told = dict(re.findall(r"^\| `(/[\w/]+)` \| `(\w+/(?:msg|srv|action)/\w+)` \|", page, re.M))
    wait_until(lambda: "btlang_sim" in client.node.get_node_names(), "the node")

    def offered() -> dict[str, str]:
        node = ("btlang_sim", "/")
        found = client.node.get_publisher_names_and_types_by_node(*node)
        found += client.node.get_subscriber_names_and_types_by_node(*node)
        found += client.node.get_service_names_and_types_by_node(*node)
        found = [(name, kind.replace("_FeedbackMessage", "")) for name, [kind] in found]
        found = [(name.removesuffix("/_action/feedback"), kind) for name, kind in found]
        return {name: kind for name, kind in found if "/_action/" not in name and "btlang_sim" not in name}

    wait_until(lambda: set(offered()) >= set(told), "all names")
    everywhere = {"/rosout": "rcl_interfaces/msg/Log", "/parameter_events": "rcl_interfaces/msg/ParameterEvent"}
    assert offered() == told | everywhere

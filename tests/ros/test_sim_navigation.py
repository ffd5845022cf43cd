"""/navigate_to_pose of `btc sim-ros`, from another process, by an interface equal to Nav2's."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import cos, hypot, nan, radians, sin

import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from std_srvs.srv import Trigger

from tests.ros.client import Client, Goal, Heard
from tests.ros.processes import wait_until


def goal(nav2, x: float, y: float, facing: float = 0.0, frame: str = "map"):
    pose = PoseStamped()
    pose.header.frame_id = frame
    pose.pose.position.x, pose.pose.position.y = x, y
    pose.pose.orientation.z, pose.pose.orientation.w = sin(radians(facing) / 2), cos(radians(facing) / 2)
    return nav2.Goal(pose=pose)


def stands(odometry: Odometry) -> bool:
    return (odometry.twist.twist.linear.x, odometry.twist.twist.angular.z) == (0.0, 0.0)


def seconds(stamp) -> float:
    return stamp.sec + stamp.nanosec * 1e-9


@pytest.fixture
def odometry(sim, client: Client) -> Heard:
    heard = client.hear(Odometry, "/odom")
    heard.wait()
    return heard


@pytest.fixture
def send(nav2, sim, client: Client) -> Callable[..., Goal]:
    """Sends a goal to the navigation."""
    return partial(Goal, client, client.action(nav2, "/navigate_to_pose"))


def under_way(send: Callable[..., Goal], pose: object, odometry: Heard) -> Goal:
    """A goal that has been accepted, once the robot rolls (which it may do before the answer is here)."""
    before = len(odometry.messages)
    sent = send(pose)
    assert sent.accepted
    odometry.wait(lambda message: message.twist.twist.linear.x > 0.1, before)
    return sent


def ended(sent: Goal) -> tuple[int, int, str]:
    outcome = sent.result()
    return outcome.status, outcome.result.error_code, outcome.result.error_msg


def test_the_definition_is_that_of_nav2(nav2):
    assert nav2.Goal.get_fields_and_field_types() == {
        "pose": "geometry_msgs/PoseStamped",
        "behavior_tree": "string",
    }
    assert nav2.Result.get_fields_and_field_types() == {"error_code": "uint16", "error_msg": "string"}
    assert nav2.Result.NONE == 0
    assert nav2.Feedback.get_fields_and_field_types() == {
        "current_pose": "geometry_msgs/PoseStamped",
        "navigation_time": "builtin_interfaces/Duration",
        "estimated_time_remaining": "builtin_interfaces/Duration",
        "number_of_recoveries": "int16",
        "distance_remaining": "float",
    }


def test_it_arrives_and_faces_as_told(nav2, start_sim, client: Client):
    start_sim("--speed", "4")  # at 20 a busy machine loses some of the feedback
    odometry = client.hear(Odometry, "/odom")
    sent = Goal(client, client.action(nav2, "/navigate_to_pose"), goal(nav2, 4.0, 3.0, facing=180.0))
    assert ended(sent) == (GoalStatus.STATUS_SUCCEEDED, nav2.Result.NONE, "")
    at = odometry.next().pose.pose
    assert hypot(at.position.x - 4.0, at.position.y - 3.0) < 0.05
    assert abs(at.orientation.z) == pytest.approx(1.0, abs=0.001)
    feedback = sent.feedback.messages
    assert len(feedback) > 20
    assert feedback[0].distance_remaining > 2.5 > 0.3 > feedback[-1].distance_remaining
    times = [seconds(message.navigation_time) for message in feedback]
    assert times == sorted(times)
    assert 0.19 < times[1] - times[0] < 0.26
    assert feedback[-1].current_pose.header.frame_id == "map"
    assert feedback[0].estimated_time_remaining.sec >= 5


def test_cancelled_half_way_it_stands_still(nav2, start_sim, client: Client):
    start_sim("--speed", "2")
    odometry = client.hear(Odometry, "/odom")
    sent = under_way(partial(Goal, client, client.action(nav2, "/navigate_to_pose")), goal(nav2, 5.0, 1.0), odometry)
    assert sent.cancel() == 1
    cancelled = seconds(odometry.messages[-1].header.stamp)
    status, _, reason = ended(sent)
    assert (status, reason) == (GoalStatus.STATUS_CANCELED, "navigation was cancelled")
    assert odometry.wait(stands).pose.pose.position.x < 4.0
    rolling = [message for message in odometry.messages if not stands(message)]
    assert seconds(rolling[-1].header.stamp) - cancelled < 1.0


def test_cancelled_at_once(nav2, send, odometry: Heard):
    sent = send(goal(nav2, 5.0, 1.0))
    sent.cancel()
    assert ended(sent)[0] == GoalStatus.STATUS_CANCELED
    odometry.wait(stands)


def test_a_new_goal_takes_the_place_of_the_one_under_way(nav2, send, odometry: Heard):
    first = under_way(send, goal(nav2, 5.0, 1.0, -90.0), odometry)
    second = send(goal(nav2, 2.0, 1.0))
    status, code, reason = ended(first)
    assert (status, reason) == (GoalStatus.STATUS_ABORTED, "the robot set out for (2.00, 1.00) instead")
    assert code != nav2.Result.NONE
    assert ended(second)[0] == GoalStatus.STATUS_SUCCEEDED
    assert odometry.next().pose.pose.position.x == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize(
    ("x", "y", "frame", "reason"),
    [
        (20.0, 20.0, "map", "there is no free way to (20.00, 20.00)"),
        (5.0, 3.0, "map", "there is no free way to the attic"),
        (2.0, 2.0, "base_link", "the goal is in the frame base_link, and the robot knows only map and odom"),
        (nan, 2.0, "", "the goal is no pose: one of its numbers is infinite, or not a number"),
    ],
)
def test_why_it_does_not_arrive(nav2, send, x: float, y: float, frame: str, reason: str):
    status, code, told = ended(send(goal(nav2, x, y, frame=frame)))
    assert (status, told) == (GoalStatus.STATUS_ABORTED, reason)
    assert code != nav2.Result.NONE


def test_a_refused_goal_leaves_the_one_under_way_alone(nav2, send, odometry: Heard):
    first = under_way(send, goal(nav2, 4.0, 2.0), odometry)
    refused = send(goal(nav2, nan, 1.0))
    assert ended(refused)[0] == GoalStatus.STATUS_ABORTED
    assert ended(first)[0] == GoalStatus.STATUS_SUCCEEDED


def test_a_thing_is_approached_as_by_its_name(nav2, send, odometry: Heard):
    away = send(goal(nav2, 3.0, 2.0))
    assert ended(away)[0] == GoalStatus.STATUS_SUCCEEDED
    back = send(goal(nav2, 0.7, 2.25))
    assert ended(back)[0] == GoalStatus.STATUS_SUCCEEDED
    at = odometry.next().pose.pose.position
    assert 0.2 < hypot(at.x - 0.7, at.y - 2.25) < 0.6


def test_a_stop_ends_it_and_says_so(nav2, send, odometry: Heard, client: Client):
    sent = under_way(send, goal(nav2, 5.0, 1.0), odometry)
    assert client.call(Trigger, "/stop").success
    assert ended(sent)[::2] == (GoalStatus.STATUS_ABORTED, "the robot was stopped")
    odometry.wait(stands)


def test_a_command_to_move_ends_it_and_a_zero_does_not(nav2, send, odometry: Heard, client: Client):
    wheels = client.publisher(Twist, "/cmd_vel")
    sent = under_way(send, goal(nav2, 5.0, 1.0), odometry)
    result = sent.ending()
    wheels.publish(Twist())
    odometry.next()
    odometry.next()
    assert not result.done()
    turn = Twist()
    turn.angular.z = 1.0
    wheels.publish(turn)
    wait_until(result.done, "the end of the journey")
    assert result.result().result.error_msg == "another command took over the drive"
    odometry.wait(stands)


def test_it_ends_by_a_signal_while_a_goal_is_under_way(nav2, sim, send, odometry: Heard):
    under_way(send, goal(nav2, 5.0, 1.0), odometry)
    assert sim.end() == 130

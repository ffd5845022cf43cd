"""Which messages are believed. They go through the gate in the order in which they come."""

from __future__ import annotations

import math
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64

from btlang.ros.messages import echoes
from btlang.ros.subscriptions import MessageGate

NAN, INF = math.nan, math.inf


def odometry(x: float = 0.0, w: float = 1.0, speed: float = 0.0, turn: float = 0.0, at: int = 1) -> Odometry:
    message = Odometry()
    message.header.stamp.sec = at
    message.pose.pose.position.x, message.pose.pose.orientation.w = x, w
    message.twist.twist.linear.x, message.twist.twist.angular.z = speed, turn
    return message


def scan(*ranges: float, step: float = 0.1, low: float = 0.1, high: float = 10.0) -> LaserScan:
    return LaserScan(angle_increment=step, range_min=low, range_max=high, ranges=list(ranges))


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (odometry(), ""),
        (odometry(w=0.98), ""),
        (odometry(x=NAN), "sends numbers that are not finite"),
        (odometry(x=-INF), "sends numbers that are not finite"),
        (odometry(w=NAN), "sends numbers that are not finite"),
        (odometry(speed=INF), "sends numbers that are not finite"),
        (odometry(turn=NAN), "sends numbers that are not finite"),
        (odometry(w=0.0), "sends an invalid quaternion"),
        (odometry(w=2.0), "sends an invalid quaternion"),
        (odometry(x=1e9), "says that the robot is 1e+09 m away"),
        (odometry(speed=300.0), "says that the robot moves at 300 m/s and turns at 0 rad/s"),
        (scan(1.0), ""),
        (scan(INF, NAN), ""),
        (scan(-INF, NAN), ""),
        (scan(12.0), ""),
        (scan(), "has no valid beam"),
        (scan(NAN, NAN), "has no valid beam"),
        (scan(-1.0, 0.0, 0.05), "has no valid beam"),
        (scan(1.0, low=NAN), "has no valid beam"),
        (scan(1.0, high=0.0), ""),
        (scan(1.0, step=0.0), "doesn't say where its beams point"),
        (scan(1.0, step=NAN), "doesn't say where its beams point"),
        (scan(1.0, step=1e30), "doesn't say where its beams point"),
        (LaserScan(angle_min=1e30, angle_increment=0.1, ranges=[1.0]), "doesn't say where its beams point"),
        (Float64(data=NAN), ""),
    ],
)
def test_one_message(message: Any, reason: str) -> None:
    assert MessageGate(type(message)).refuses(message) == reason


@pytest.mark.parametrize("kind", [PoseStamped, PoseWithCovarianceStamped])
def test_poses_of_other_messages(kind: type) -> None:
    message = kind()
    assert MessageGate(kind).refuses(message) == ""
    getattr(message.pose, "pose", message.pose).position.y = NAN
    assert MessageGate(kind).refuses(message) == "sends numbers that are not finite"


def test_a_jump_is_refused_once() -> None:
    """What follows agrees with it: odometry that began anew. Who drives sees how far that is."""
    gate = MessageGate(Odometry, lags=False)
    assert gate.refuses(odometry(x=0.0, at=10)) == ""
    assert gate.refuses(odometry(x=0.5, at=11)) == ""
    assert gate.refuses(odometry(x=90.5, at=12)) == "jumps by 90 m"
    assert gate.refuses(odometry(x=91.0, at=13)) == ""
    assert gate.refuses(odometry(x=0.0, at=1)) == "jumps by 91 m"


def test_what_a_beam_says() -> None:
    given = scan(1.0, INF, 11.0, -INF, NAN, 0.0, 0.05, -2.0)
    assert [round(echo, 2) for echo in echoes(given)[:4]] == [1.0, INF, INF, 0.1]
    assert all(map(math.isnan, echoes(given)[4:]))
    assert echoes(scan(-INF, low=0.0))[0] > 0.0
    assert list(echoes(scan(5.0, high=0.0))) == [5.0]

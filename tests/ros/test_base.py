"""What a base tells a real listener on /cmd_vel, and when it counts as stuck, with odometry that the test gives."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

from btlang.robots.robot import RobotError
from btlang.ros.node import SpunNode
from btlang.ros.robot.base import RosBase
from tests.ros.client import Client, Heard
from tests.ros.processes import wait_until


class Told:
    """Odometry as a test tells it: where the robot is, and how fast it says that it is."""

    def __init__(self) -> None:
        self.message = Odometry()
        self.tell(0.0)

    def tell(self, x: float, speed: float = 0.0) -> None:
        self.message = Odometry()
        self.message.pose.pose.position.x, self.message.twist.twist.linear.x = x, speed

    def listen(self, *arguments: object, **options: object) -> None:
        pass

    def get(self, topic: str, limit: float | None = None) -> Any:
        return self.message


class Bench:
    """A base and who listens to it."""

    def __init__(self, base: RosBase, odometry: Told, heard: Heard) -> None:
        self.base, self.odometry, self.heard = base, odometry, heard

    def step(self, seconds: float, speed: float = 0.0, moves: float = 0.0) -> None:
        """Steps of 0.05 s with new odometry each, which says `speed` and moves by `moves` metres a second."""
        for _ in range(round(seconds / 0.05)):
            self.odometry.tell(self.odometry.message.pose.pose.position.x + 0.05 * moves, speed)
            self.base.step(0.05)


@pytest.fixture
def bench(domain: int, client: Client) -> Iterator[Bench]:
    """A base that somebody listens to."""
    heard = client.hear(Twist, "/cmd_vel")
    odometry = Told()
    with SpunNode("base", domain_id=domain) as spun:
        base = RosBase(spun.node, odometry, 0.2, (1.0, 180.0))  # type: ignore[arg-type]
        wait_until(lambda: base.adapt() and spun.node.count_subscribers("/cmd_vel"), "a listener")
        wait_until(lambda: base.drive(0.0, 0.0) or heard.messages, "a first zero")
        yield Bench(base, odometry, heard)


def test_a_base_that_never_sets_off_is_stuck(bench: Bench) -> None:
    bench.base.drive(0.5, 0.0)
    bench.step(2.9)
    assert not bench.base.stuck
    bench.step(0.3)
    assert bench.base.stuck


def test_one_that_stands_for_a_second_on_its_way_is_stuck(bench: Bench) -> None:
    bench.base.drive(0.5, 0.0)
    bench.step(1.0, moves=0.5, speed=0.5)
    bench.step(0.9)
    assert not bench.base.stuck
    bench.step(0.2)
    assert bench.base.stuck


def test_wheels_that_say_they_turn_do_not_hide_a_pose_that_stands(bench: Bench) -> None:
    bench.base.drive(0.5, 0.0)
    bench.step(1.2, speed=0.5)
    assert bench.base.stuck


def test_one_that_sets_off_late_gets_its_second_from_then_on(bench: Bench) -> None:
    bench.base.drive(0.5, 0.0)
    bench.step(1.5)
    bench.step(0.2, speed=0.03)
    assert not bench.base.stuck
    bench.step(1.2, speed=0.03)
    assert bench.base.stuck


def test_one_that_braked_since_a_step_came_late_is_not_stuck(bench: Bench) -> None:
    bench.base.drive(0.5, 0.0)
    bench.step(0.5, moves=0.5, speed=0.5)
    bench.odometry.tell(0.25)
    bench.base.step(3.0)
    assert not bench.base.stuck


def test_a_command_that_nobody_can_hear_makes_no_base_stuck(domain: int) -> None:
    with SpunNode("base", domain_id=domain) as spun:
        odometry = Told()
        base = RosBase(spun.node, odometry, 0.2, (1.0, 180.0))  # type: ignore[arg-type]
        base.drive(0.5, 0.0)
        Bench(base, odometry, Heard()).step(9.0)
        assert not base.stuck


def test_a_velocity_is_told_once_a_tick(bench: Bench) -> None:
    for speed in (0.1, 0.2, 0.3):  # a leaf drives, then the tick is over
        bench.base.drive(speed, 0.0)
        bench.step(0.05, moves=0.1)
    bench.step(0.1, moves=0.3)  # no leaf drives: it is told again
    bench.base.drive(0.0, 0.0)
    wait_until(lambda: [message.linear.x for message in bench.heard.messages[-2:]] == [0.3, 0.0], "the last zero")
    told = [message.linear.x for message in bench.heard.messages]
    assert told[told.index(0.1) :] == [0.1, 0.2, 0.3, 0.3, 0.3, 0.0]


@pytest.mark.parametrize(("linear", "angular"), [(math.nan, 0.0), (0.2, math.nan), (math.inf, 0.0), (0.0, -math.inf)])
def test_what_is_no_velocity_is_not_told_but_zero_is(bench: Bench, linear: float, angular: float) -> None:
    bench.base.drive(0.3, 0.0)
    with pytest.raises(RobotError, match="is not finite"):
        bench.base.drive(linear, angular)
    bench.step(0.1)
    bench.base.drive(7.0, 0.0)
    bench.heard.wait(lambda message: message.linear.x == 1.0)
    told = [(message.linear.x, message.angular.z) for message in bench.heard.messages]
    assert told[-3:] == [(0.3, 0.0), (0.0, 0.0), (1.0, 0.0)]

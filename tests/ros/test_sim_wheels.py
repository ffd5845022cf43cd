"""The wheels of the simulated robot, where velocities and goals arrive in another order than they were sent."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from geometry_msgs.msg import Twist

from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world_file import load_world
from btlang.ros.simulator import base as wheels_module
from btlang.ros.simulator.base import BaseTopics
from btlang.ros.simulator.shared import CallQueue
from tests.ros.client import Client
from tests.ros.processes import ROOM, wait_until


class Counting(CallQueue):
    """Counts what is handed over."""

    posted = 0

    def post(self, job: Callable[[], object]) -> None:
        super().post(job)
        self.posted += 1


def test_velocities_that_were_sent_before_a_goal_leave_it_alone(
    client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 100.0
    monkeypatch.setattr(wheels_module, "monotonic", lambda: now)
    robot, calls = SimulatedRobot(load_world(ROOM)), Counting()
    wheels = BaseTopics(client.node, robot, calls)
    publisher = client.publisher(Twist, "/cmd_vel")

    def drive(speed: float) -> None:
        twist, posted = Twist(), calls.posted
        twist.linear.x = speed
        publisher.publish(twist)
        wait_until(lambda: calls.posted > posted, "the velocity")
        calls.work(0.0)
        robot.step(0.05)

    drive(0.3)
    goal = robot.navigate_to("lab")
    wheels.leave()
    drive(0.3)
    assert not goal.done
    drive(0.0)  # nothing is on the way any more
    assert not goal.done
    drive(0.3)
    assert goal.failure == "another command took over the drive"

    for seconds, failure in ((0.2, None), (0.4, "another command took over the drive")):
        drive(0.3)
        goal = robot.navigate_to("lab")
        wheels.leave()
        now += seconds
        drive(0.3)
        assert goal.failure == failure
        drive(0.0)

    goal = robot.navigate_to("lab")  # the base stood before
    wheels.leave()
    drive(0.3)
    assert goal.failure == "another command took over the drive"

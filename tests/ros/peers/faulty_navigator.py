"""A robot that its navigation server drives on, whatever it is told. `faulty_navigator.py MODE [phrase]`

What the server does with a cancel is its MODE: `reject` refuses it, `ignore` never answers, `linger` accepts it and
never ends the goal, `lie` says at once that the goal is cancelled. In each the robot goes on at 0.3 m/s; `obey` stops
it. With `phrase` it serves /actions/move_forward as `btc serve-actions` would, in place of /navigate_to_pose.
"""

from __future__ import annotations

import sys
from typing import Any

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from tests.ros.peers.peer import a_moment, serve, tell

if "phrase" in sys.argv:
    from btlang_interfaces.action import RunPhrase as Action

    NAME = "/actions/move_forward"
else:
    from nav2_msgs.action import NavigateToPose as Action

    NAME = "/navigate_to_pose"
MODE = sys.argv[1]
SPEED = 0.3
PERIOD = 0.02


class Robot:
    """Its wheels hear the server alone; it prints each zero that others tell it."""

    def __init__(self, node: Node) -> None:
        self.speed = self.x = 0.0
        self.odometry = node.create_publisher(Odometry, "/odom", 10)
        node.create_subscription(Twist, "/cmd_vel", self.told, 10)
        node.create_timer(PERIOD, self.step)
        self.server = ActionServer(
            node, Action, NAME, self.go, cancel_callback=self.cancel,
            callback_group=ReentrantCallbackGroup(),
        )  # fmt: skip

    def told(self, twist: Twist) -> None:
        tell("zero" if (twist.linear.x, twist.angular.z) == (0.0, 0.0) else "drive")

    def step(self) -> None:
        self.x += self.speed * PERIOD
        odometry = Odometry()
        odometry.pose.pose.position.x, odometry.pose.pose.orientation.w = self.x, 1.0
        odometry.twist.twist.linear.x = self.speed
        self.odometry.publish(odometry)

    async def cancel(self, goal: Any) -> CancelResponse:
        tell("cancel")
        while MODE == "ignore":
            await a_moment()
        return CancelResponse.REJECT if MODE == "reject" else CancelResponse.ACCEPT

    async def go(self, goal: Any) -> Action.Result:
        self.speed = SPEED
        tell("going")
        while MODE not in ("lie", "obey") or not goal.is_cancel_requested:
            goal.publish_feedback(Action.Feedback())
            await a_moment()
        if MODE == "obey":
            self.speed = 0.0
        goal.canceled()
        return Action.Result()


if __name__ == "__main__":
    serve("faulty_navigator", Robot)

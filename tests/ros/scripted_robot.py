"""A robot that does what a test wants it to: a base that integrates /cmd_vel, a navigation server with manners or not.

    python -m tests.ros.scripted_robot [base] [scan] [navigation=MANNER] [speech] [hand=MANNER]

It prints what it is told, a line each, from "ready" on. Two processes may share the parts.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from math import cos, sin
from threading import Event
from typing import Any

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

PERIOD = 0.02


class Base:
    """Moves at once as it is told. "frozen" it never moves, "mute" it tells nothing once it has moved for 0.3 m;
    "stamped" it listens to TwistStamped.
    """

    def __init__(self, node: Node, manner: str) -> None:
        self._node, self._manner = node, manner
        self._x = self._y = self._heading = self._linear = self._angular = 0.0
        self._odometry = node.create_publisher(Odometry, "/odom", 10)
        if manner == "stamped":
            node.create_subscription(TwistStamped, "/cmd_vel", self._drive_stamped, 10)
        else:
            node.create_subscription(Twist, "/cmd_vel", self._drive, 10)
        node.create_timer(PERIOD, self._move)

    def _drive_stamped(self, message: TwistStamped) -> None:
        if message.header.stamp.sec and message.header.frame_id == "base_link":
            self._drive(message.twist)

    def _drive(self, twist: Twist) -> None:
        if (twist.linear.x, twist.angular.z) != (self._linear, self._angular):
            print(f"drive {twist.linear.x:.3f} {twist.angular.z:.3f} at {self._x:.3f}", flush=True)
        self._linear, self._angular = twist.linear.x, twist.angular.z

    def _move(self) -> None:
        linear, angular = (0.0, 0.0) if self._manner == "frozen" else (self._linear, self._angular)
        self._x += PERIOD * linear * cos(self._heading)
        self._y += PERIOD * linear * sin(self._heading)
        self._heading += PERIOD * angular
        if self._manner == "mute" and self._x > 0.3:
            return
        message = Odometry()
        message.header.stamp = self._node.get_clock().now().to_msg()
        message.pose.pose.position.x, message.pose.pose.position.y = self._x, self._y
        message.pose.pose.orientation.z, message.pose.pose.orientation.w = (
            sin(self._heading / 2),
            cos(self._heading / 2),
        )
        message.twist.twist.linear.x, message.twist.twist.angular.z = linear, angular
        self._odometry.publish(message)


class Navigation:
    """What it does with a goal is its manner."""

    def __init__(self, node: Node, manner: str) -> None:
        from nav2_msgs.action import NavigateToPose

        self._manner, self._result = manner, NavigateToPose.Result
        self._feedback = NavigateToPose.Feedback
        self._over = Event()
        ActionServer(
            node,
            NavigateToPose,
            "/navigate_to_pose",
            self._go,
            goal_callback=self._asked,
            cancel_callback=self._cancelled,
            callback_group=ReentrantCallbackGroup(),
        )

    def _asked(self, goal: Any) -> GoalResponse:
        print(f"goal {goal.pose.pose.position.x:.2f} {goal.pose.pose.position.y:.2f}", flush=True)
        if self._manner == "slow":
            time.sleep(1.5)
        if self._manner == "mute":
            self._over.wait()
        return GoalResponse.REJECT if self._manner == "reject" else GoalResponse.ACCEPT

    def _cancelled(self, goal: Any) -> CancelResponse:
        print("cancel", flush=True)
        return CancelResponse.ACCEPT

    def _go(self, goal: Any) -> Any:
        print("accepted", flush=True)
        if self._manner == "abort":
            goal.abort()
            return self._result(error_code=9000, error_msg="the door is shut")
        if self._manner == "arrive":
            time.sleep(0.3)
            goal.succeed()
            return self._result()
        goal.publish_feedback(self._feedback())
        while not goal.is_cancel_requested and not self._over.wait(0.02):
            pass
        print("cancelled", flush=True)
        goal.canceled()
        return self._result()


def hand(node: Node, manner: str) -> None:
    """The service of the right hand: "full" says no, "mute" never answers."""

    def close(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if manner == "mute":
            time.sleep(3600)
        response.success, response.message = False, "the right hand already holds the cup"
        return response

    node.create_service(SetBool, "/right_hand/close", close)


def main() -> None:
    """Until a signal ends it."""
    rclpy.init()
    node = rclpy.create_node(f"scripted_{os.getpid()}")
    kept: list[Any] = []
    for part in sys.argv[1:]:
        name, _, manner = part.partition("=")
        if name == "base":
            kept.append(Base(node, manner))
        elif name == "navigation":
            kept.append(Navigation(node, manner))
        elif name == "hand":
            hand(node, manner)
        elif name == "speech":
            node.create_subscription(String, "/speech", lambda text: print(f"speech {text.data!r}", flush=True), 10)
    signal.signal(signal.SIGTERM, lambda *_: os._exit(0))
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    print("ready", flush=True)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        os._exit(0)


if __name__ == "__main__":
    main()

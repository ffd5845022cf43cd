"""A program that sends a mission to /btlang/run_mission with a lease. `mission_client.py MISSION [SECONDS]`

Then it holds up all of its Python threads for some seconds, and waits.
"""

from __future__ import annotations

import sys
import time

from btlang_interfaces.action import RunMission
from rclpy.action import ActionClient
from rclpy.node import Node

from btlang.ros.lease import Lease
from tests.ros.peers.peer import serve, tell


class Client:
    """Sends the goal once the server is there."""

    def __init__(self, node: Node) -> None:
        self.lease = Lease(node)
        self.client = ActionClient(node, RunMission, "/btlang/run_mission")
        self.timer = node.create_timer(0.1, self.send)

    def send(self) -> None:
        if self.client.server_is_ready():
            self.timer.cancel()
            goal = RunMission.Goal(mission=sys.argv[1])
            sent = self.client.send_goal_async(goal, goal_uuid=self.lease.goal_id())
            sent.add_done_callback(lambda _: _hold(float(sys.argv[2])) if len(sys.argv) > 2 else None)


def _hold(seconds: float) -> None:
    """Calculates so that no other thread of Python runs meanwhile."""
    tell("held up")
    sys.setswitchinterval(1000.0)
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        pow(3, 200_000)
    sys.setswitchinterval(0.005)
    tell("goes on")


if __name__ == "__main__":
    serve("mission_client", Client)

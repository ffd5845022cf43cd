"""An action server of nav2_msgs/action/NavigateToPose. `navigator.py MODE [SECONDS]`

MODE is `arrive` (after SECONDS), `hang` (until it is cancelled), `slow` (accepts after SECONDS, then hangs), `lost`
(as `hang`, but its answer that it accepts gets lost, as it may in DDS), `reject`,
`abort` (for a reason), `blame` (succeeds with an error code), `code` (the same without a word), `meddle` (cancels its
goals after SECONDS) or `still` (gives feedback and goes nowhere, until it is cancelled). It tells when it has found a
client: answers to one that it hasn't found get lost.
"""

from __future__ import annotations

import sys
import time
from typing import Any

from action_msgs.srv import CancelGoal
from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from tests.ros.peers.peer import a_moment, pause, serve, tell

MODE = sys.argv[1]
SECONDS = float(sys.argv[2]) if len(sys.argv) > 2 else 0.2


async def _goal(goal: Any) -> GoalResponse:
    pose = goal.pose
    tell("goal", pose.header.frame_id, *(f"{v:.3f}" for v in (pose.pose.position.x, pose.pose.position.y)),
         f"{pose.pose.orientation.z:.3f}", f"{pose.pose.orientation.w:.3f}")  # fmt: skip
    if MODE == "slow":
        await pause(SECONDS)
    return GoalResponse.REJECT if MODE == "reject" else GoalResponse.ACCEPT


def _cancel(handle: Any) -> CancelResponse:
    tell("cancel")
    return CancelResponse.ACCEPT


async def _execute(handle: Any) -> NavigateToPose.Result:
    tell("executing")
    result = NavigateToPose.Result()
    until = time.monotonic() + SECONDS
    while MODE in ("hang", "slow", "lost", "meddle", "still") or time.monotonic() < until:
        if handle.is_cancel_requested:
            handle.canceled()
            tell("cancelled")
            return result
        if MODE == "still":
            handle.publish_feedback(NavigateToPose.Feedback())
            await pause(0.05)
        await a_moment()
    if MODE == "abort":
        result.error_code, result.error_msg = 7, "the way is blocked by a box"
        handle.abort()
    elif MODE in ("blame", "code"):
        result.error_code, result.error_msg = 9, "the map is too old" if MODE == "blame" else ""
        handle.succeed()
    else:
        handle.succeed()
    tell("ended")
    return result


class _Losing:
    """What is below a server, but for the answers to goals."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle

    def __getattr__(self, name: str) -> Any:
        return getattr(self._handle, name)

    def send_goal_response(self, *_: object) -> None:
        tell("lost")


def _make(node: Node) -> object:
    if MODE == "meddle":  # a request that names no goal is for all of them
        client = node.create_client(CancelGoal, "/navigate_to_pose/_action/cancel_goal")
        node.create_timer(SECONDS, lambda: client.call_async(CancelGoal.Request()))
    server = ActionServer(
        node, NavigateToPose, "/navigate_to_pose", _execute, goal_callback=_goal, cancel_callback=_cancel,
        callback_group=ReentrantCallbackGroup(),
    )  # fmt: skip
    if MODE == "lost":
        server._handle = _Losing(server._handle)
    _tell_found(node)
    return server


def _tell_found(node: Node) -> None:
    """Tells once that there is a client, with all that it needs to hear its answers."""

    def look() -> None:
        if all(node.count_clients(f"/navigate_to_pose/_action/{name}") for name in ("send_goal", "get_result")):
            tell("found")
            timer.cancel()

    timer = node.create_timer(0.02, look)


if __name__ == "__main__":
    serve("navigator", _make)

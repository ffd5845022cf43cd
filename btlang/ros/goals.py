"""Goals of actions: servers whose goals other threads work on, and a handle of a goal by its id alone."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from types import SimpleNamespace
from typing import Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import GoalEvent, ServerGoalHandle
from rclpy.node import Node
from rclpy.qos import QoSProfile
from unique_identifier_msgs.msg import UUID

from btlang.ros.lease import Leases

_MANY = QoSProfile(depth=1000)  # of requests at once; more than ten get lost by default
GONE = "its client is gone"
"""Why a goal is cancelled when its client has died."""


def goal_handle(client: Any, goal_id: UUID) -> ClientGoalHandle:
    """Return a handle of a goal that was sent and not answered, to cancel it or to get its result."""
    return ClientGoalHandle(client, goal_id, SimpleNamespace(accepted=True))


class HeldGoal:
    """A goal that was accepted and goes on until `end`. Both methods are for any thread."""

    def __init__(self, handle: ServerGoalHandle, end: Callable[[bool, Any], object]) -> None:
        self.request: Any = handle.request
        self._handle = handle
        self._end = end

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback to the client."""
        self._handle.publish_feedback(feedback)

    def end(self, success: bool, result: Any) -> None:
        """Send the result: the goal has succeeded, was cancelled if somebody asked for that, or else aborted."""
        self._end(success, result)


class GoalServer:
    """An action server for any number of goals, as far as `accepts` takes them.

    `begin` starts the work of an accepted goal and returns a function that cancels it, for a reason; the work calls
    `HeldGoal.end` once, also after that. A goal whose client has died is cancelled too (see lease.py). All these
    functions are called in the thread of the executor and must not wait.
    """

    def __init__(
        self,
        node: Node,
        action: Any,
        name: str,
        begin: Callable[[HeldGoal], Callable[[str], object]],
        leases: Leases,
        accepts: Callable[[], bool] = lambda: True,
    ) -> None:
        self._begin = begin
        self._cancels: dict[bytes, Callable[[str], object]] = {}
        self._leases = leases
        self._server = ActionServer(
            node,
            action,
            name,
            execute_callback=lambda handle: action.Result(),
            goal_callback=lambda request: GoalResponse.ACCEPT if accepts() else GoalResponse.REJECT,
            handle_accepted_callback=self._accept,
            cancel_callback=self._cancel,
            goal_service_qos_profile=_MANY,
            result_service_qos_profile=_MANY,
            cancel_service_qos_profile=_MANY,
        )

    def _accept(self, handle: ServerGoalHandle) -> None:
        # handle.execute() would occupy the executor until the work ends: the goal only says that it executes
        handle._update_state(GoalEvent.EXECUTE)

        def end(success: bool, result: Any) -> None:
            self._server.notify_execute(handle, partial(self._finish, success, result))

        goal_id = bytes(handle.goal_id.uuid)
        cancel = self._cancels[goal_id] = self._begin(HeldGoal(handle, end))
        self._leases.watch(goal_id, lambda: cancel(GONE))

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        cancel = self._cancels.get(bytes(handle.goal_id.uuid))
        if cancel is not None:
            cancel("it was cancelled")
        return CancelResponse.ACCEPT

    def _finish(self, success: bool, result: Any, handle: ServerGoalHandle) -> Any:
        """Finish a goal, in the thread of the executor, after the request to cancel it was answered."""
        goal_id = bytes(handle.goal_id.uuid)
        self._cancels.pop(goal_id, None)
        self._leases.forget(goal_id)
        if success:
            handle.succeed()
        elif handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return result

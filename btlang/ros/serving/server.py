"""The node with an action server for each action."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from btlang_interfaces.action import RunPhrase
from rclpy.node import Node as RosNode
from std_srvs.srv import Trigger

from btlang.engine.leaves.leaf import ActionFailed
from btlang.ros.goals import GoalServer, HeldGoal
from btlang.ros.lease import Leases
from btlang.ros.serving.goal_executor import GoalExecutor
from btlang.ros.serving.names import FOLDER, action_name
from btlang.ros.serving.requested_leaf import make_leaf
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class _Caller:
    """A client of the action server, as a Caller."""

    def __init__(self, goal: HeldGoal) -> None:
        self._goal = goal

    def report(self, share: float, state: str) -> None:
        self._goal.publish_feedback(RunPhrase.Feedback(progress=share, state=state))

    def end(self, success: bool, reason: str) -> None:
        self._goal.end(success, RunPhrase.Result(success=success, reason=reason))


def serve_actions(
    node: RosNode, ids: Iterable[str], vocabulary: Lexicon, executor: GoalExecutor, stop: Callable[[], object]
) -> None:
    """Serve each action by its name, and ~/stop, the emergency stop, which calls `stop`.

    A goal that makes no sense is accepted and aborted: ROS 2 can't give a reason for a rejected one.
    """

    def stopped(request: Any, response: Any) -> Any:
        stop()
        response.success = True
        return response

    leases = Leases(node)
    node.create_service(Trigger, "~/stop", stopped)
    for node_id in ids:
        GoalServer(
            node, RunPhrase, f"{FOLDER}/{action_name(node_id)}", _beginner(node_id, vocabulary, executor), leases
        )


def _beginner(
    node_id: str, vocabulary: Lexicon, executor: GoalExecutor
) -> Callable[[HeldGoal], Callable[[str], object]]:
    entries = vocabulary.entries[node_id]

    def begin(goal: HeldGoal) -> Callable[[str], object]:
        caller, asked = _Caller(goal), goal.request
        try:
            leaf = make_leaf(asked.phrase, asked.names, asked.values, entries, vocabulary)
        except ActionFailed as problem:
            caller.end(False, str(problem))
            return lambda reason: None
        return executor.begin(leaf, caller)

    return begin

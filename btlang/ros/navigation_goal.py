"""Navigation by the action NavigateToPose."""

from __future__ import annotations

from collections.abc import Callable

from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionClient
from rclpy.node import Node

from btlang.robots.body import TOLERANCE
from btlang.robots.geometry import Pose
from btlang.robots.world import said
from btlang.ros.executor_thread import ExecutorThread
from btlang.ros.poses import stamped_pose
from btlang.ros.server_goal import ServerGoal, ServerGoals, Task

ACTION = "navigate_to_pose"


class RosNavigation(ServerGoals):
    """The client of the navigation server, and the goal under way."""

    def __init__(
        self,
        node: Node,
        executor: ExecutorThread,
        where: Callable[[], Pose | None],
        now: Callable[[], float],
        localized: Callable[[], bool] = lambda: True,
        tolerance: float = TOLERANCE,
    ) -> None:
        super().__init__(node, executor, where, now, localized)
        self._tolerance = tolerance
        self._client = ActionClient(node, NavigateToPose, ACTION)
        self._server = node.resolve_service_name(ACTION)

    def start(self, name: str, pose: Pose) -> ServerGoal:
        """Sets out; a goal under way is given up."""
        self.stop(f"the robot set out for {said(name)} instead")
        goal = said(name)
        nouns = f"the navigation to {goal}", f"navigate to {goal}", f" on the way to {goal}"
        task = Task("navigation", name, *nouns, goal=pose, tolerance=self._tolerance)
        request = NavigateToPose.Goal(pose=stamped_pose(pose, self._node.get_clock().now().to_msg()))
        return self.begin(task, self._client, self._server, request)

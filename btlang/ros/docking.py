"""Docking by the actions DockRobot and UndockRobot, as Nav2's docking server does it."""

from __future__ import annotations

from collections.abc import Callable

from nav2_msgs.action import DockRobot, UndockRobot
from rclpy.action import ActionClient
from rclpy.node import Node

from btlang.robots.geometry import Pose
from btlang.ros.executor_thread import ExecutorThread
from btlang.ros.poses import stamped_pose
from btlang.ros.server_goal import ServerGoal, ServerGoals, Task

DOCK_ROBOT, UNDOCK_ROBOT = "dock_robot", "undock_robot"
_REASONS = {
    901: "the docking server doesn't know the dock",
    902: "the docking server can't use docks of this type",
    903: "the robot didn't get to the staging pose in front of the dock",
    904: "the dock wasn't detected",
    906: "the robot is in the dock, but doesn't charge",
}
_DOCKING = {**_REASONS, 905: "the robot couldn't be driven into the dock", 907: "docking took too long"}
_UNDOCKING = {**_REASONS, 905: "the robot couldn't be driven out of the dock", 907: "undocking took too long"}


class RosDocking(ServerGoals):
    """The clients of the docking server, and the goal under way. Docking drives to the staging pose by itself."""

    def __init__(
        self, node: Node, executor: ExecutorThread, where: Callable[[], Pose | None], now: Callable[[], float]
    ) -> None:
        super().__init__(node, executor, where, now)
        self._dock = ActionClient(node, DockRobot, DOCK_ROBOT)
        self._undock = ActionClient(node, UndockRobot, UNDOCK_ROBOT)

    @property
    def served(self) -> bool:
        """Whether there is a docking server."""
        return bool(self._dock.server_is_ready() and self._undock.server_is_ready())

    def dock(self, pose: Pose | None) -> ServerGoal:
        """Docks at a pose of the map; None: at the dock that the server calls "dock"."""
        self.stop("the robot docks instead")
        request = DockRobot.Goal(use_dock_id=pose is None, dock_id="" if pose is not None else "dock")
        request.navigate_to_staging_pose = True
        if pose is not None:
            request.dock_pose = stamped_pose(pose, self._node.get_clock().now().to_msg())
        task = Task("docking", "dock", "docking", "dock", " on the way into the dock", _DOCKING, False)
        return self.begin(task, self._dock, self._node.resolve_service_name(DOCK_ROBOT), request)

    def undock(self) -> ServerGoal:
        """Leaves the dock."""
        self.stop("the robot undocks instead")
        task = Task("docking", "dock", "undocking", "undock", " on the way out of the dock", _UNDOCKING, False)
        server = self._node.resolve_service_name(UNDOCK_ROBOT)
        return self.begin(task, self._undock, server, UndockRobot.Goal())

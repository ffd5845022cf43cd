"""The topics on which the node of a mission publishes."""

from __future__ import annotations

from collections.abc import Callable

from btlang_interfaces.msg import Task, Tasks, TreeStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_msgs.msg import String

from btlang.ros.node import LATCHED
from btlang.task.messages import Answer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.ros.mission.progress import News

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
_OF_A_TASK = ("id", "state", "priority", "mission", "person", "labels", "waits")
_PERIOD = 1.0  # seconds between two diagnostics


class Topics:
    """~/tree, ~/tree_changes, ~/status, ~/tasks, ~/log and /diagnostics; may be used from any thread.

    `show` gets each line of the log.
    `health` says how the node does: level, message and values; it is asked in the thread of the executor.
    """

    def __init__(
        self, node: Node, show: Callable[[str], object], health: Callable[[], tuple[bytes, str, dict[str, str]]]
    ) -> None:
        self._node, self._show, self._health = node, show, health
        self._tree = node.create_publisher(String, "~/tree", LATCHED)
        self._changes = node.create_publisher(String, "~/tree_changes", 1000)
        self._status = node.create_publisher(TreeStatus, "~/status", LATCHED)
        self._tasks = node.create_publisher(Tasks, "~/tasks", LATCHED)
        self._log = node.create_publisher(String, "~/log", 100)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        # of the machine's time, so that it also reports a simulated time that stands still
        node.create_timer(_PERIOD, self._publish_health, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def tree(self, snapshot: str) -> None:
        """The tree that runs now, with its statuses; see btlang.ros.mission.tree_topic."""
        self._tree.publish(String(data=snapshot))

    def tree_changes(self, changes: str) -> None:
        """What is new in it."""
        self._changes.publish(String(data=changes))

    def status(self, news: News) -> None:
        """The nodes that have been reached."""
        self._status.publish(filled(TreeStatus(), news))

    def tasks(self, listed: Answer) -> None:
        """The tasks that are not over, as the command `list` answers them."""
        if listed.ok:
            tasks = [Task(**{field: task[field] for field in _OF_A_TASK}) for task in listed.data["tasks"]]
            self._tasks.publish(Tasks(tasks=tasks, hindrance=listed.data["hindrance"]))

    def log(self, line: str) -> None:
        """A line of what happens."""
        self._log.publish(String(data=line))
        self._show(line)

    def complain(self, text: str) -> None:
        """What a caller did wrong, on the log of ROS too."""
        self._log.publish(String(data=text))
        self._node.get_logger().error(text)

    def _publish_health(self) -> None:
        level, message, values = self._health()
        pairs = [KeyValue(key=key, value=value) for key, value in values.items()]
        status = DiagnosticStatus(level=level, name=f"{self._node.get_name()}: mission", message=message, values=pairs)
        array = DiagnosticArray(status=[status])
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._diagnostics.publish(array)


def filled(message: Any, news: News) -> Any:
    """A TreeStatus or the feedback of RunMission with the news in it."""
    message.time, message.running = news.time, news.running
    message.paths, message.statuses = list(news.statuses), [int(status) for status in news.statuses.values()]
    return message

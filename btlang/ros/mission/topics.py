"""The topics of the mission node: the tasks, the progress and end of missions, and the tree of a run."""

from __future__ import annotations

from collections.abc import Callable

from btlang_interfaces.msg import Task as TaskMessage
from btlang_interfaces.msg import Tasks, TreeStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_msgs.msg import String

from btlang.ros.mission.progress import RunUpdate
from btlang.ros.node import LATCHED
from btlang.support.record import Record
from btlang.task.execution.executor import NOTHING_TO_DO
from btlang.task.messages import Answer
from btlang.task.store.records import Task, TaskState

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_OUTCOMES = {TaskState.COMPLETED: "success", TaskState.FAILED: "failure", TaskState.ERROR: "failure"}
_PHRASES = {"success": "succeeded", "failure": "failed", "skipped": "had nothing to do", "stopped": "was stopped"}
OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
_OF_A_TASK = ("id", "state", "priority", "mission", "person", "labels", "waits")
_PERIOD = 1.0  # seconds between two diagnostics


class MissionReport(Record):
    """How a mission ended: `outcome` is "success", "failure", "skipped" or "stopped",
    `seconds` those of the mission.
    """

    outcome: str
    reason: str = ""
    seconds: float = 0.0

    @property
    def success(self) -> bool:
        """Whether the mission succeeded; one that had nothing to do did."""
        return self.outcome in ("success", "skipped")

    def __str__(self) -> str:
        reason = f": {self.reason}" if self.reason else ""
        return f"the mission {_PHRASES[self.outcome]} after {self.seconds:.1f} s{reason}"


def report_of(task: Task, seconds: float) -> MissionReport:
    """Return the report of a task that is over."""
    if task.state is TaskState.COMPLETED and task.reason == NOTHING_TO_DO:
        return MissionReport("skipped", "", seconds)
    return MissionReport(_OUTCOMES.get(task.state, "stopped"), task.reason, seconds)


class Topics:
    """The topics ~/tree, ~/tree_changes, ~/status, ~/tasks, ~/log and /diagnostics; for any thread.

    `show` gets each line of the log. `health` returns the state of the node: level, message and values; it is called in
    the thread of the executor.
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
        """Publish the tree that runs now, with its statuses, as TreeTopic makes it."""
        self._tree.publish(String(data=snapshot))

    def tree_changes(self, changes: str) -> None:
        """Publish changes of that tree."""
        self._changes.publish(String(data=changes))

    def status(self, news: RunUpdate) -> None:
        """Publish the nodes that have been reached."""
        self._status.publish(fill_progress(TreeStatus(), news))

    def tasks(self, listed: Answer) -> None:
        """Publish the tasks that aren't over, as the command `list` answers them."""
        if listed.ok:
            tasks = [TaskMessage(**{field: task[field] for field in _OF_A_TASK}) for task in listed.data["tasks"]]
            self._tasks.publish(Tasks(tasks=tasks, hindrance=listed.data["hindrance"]))

    def log(self, line: str) -> None:
        """Publish a line of what happens."""
        self._log.publish(String(data=line))
        self._show(line)

    def complain(self, text: str) -> None:
        """Report a caller's mistake, also on the log of ROS."""
        self._log.publish(String(data=text))
        self._node.get_logger().error(text)

    def _publish_health(self) -> None:
        level, message, values = self._health()
        pairs = [KeyValue(key=key, value=value) for key, value in values.items()]
        status = DiagnosticStatus(level=level, name=f"{self._node.get_name()}: mission", message=message, values=pairs)
        array = DiagnosticArray(status=[status])
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._diagnostics.publish(array)


def fill_progress(message: Any, news: RunUpdate) -> Any:
    """Fill a TreeStatus or the feedback of RunMission with the progress of a run."""
    message.time, message.running = news.time, news.running
    message.paths, message.statuses = list(news.statuses), [int(status) for status in news.statuses.values()]
    return message

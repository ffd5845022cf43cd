"""The topics of the mission node: the tasks, the progress and end of missions, and the tree of a run."""

from __future__ import annotations

import json
import time
from collections.abc import Callable

from btlang_interfaces.msg import Task as TaskMessage
from btlang_interfaces.msg import Tasks, TreeStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_msgs.msg import String

from btlang.api import Mission
from btlang.engine.status import NAMES
from btlang.ros.node import LATCHED
from btlang.run.bus import INLINE
from btlang.run.events import Ended, PeriodPassed, StatusesChanged
from btlang.support.record import Record
from btlang.task.execution.executor import NOTHING_TO_DO
from btlang.task.messages import Answer
from btlang.task.store.records import Task, TaskState

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from btlang.run.events import Event
    from btlang.run.snapshot import Snapshot
    from btlang.session import Run


_PAUSE = 0.1  # seconds of real time between two snapshots of all nodes
_OUTCOMES = {TaskState.COMPLETED: "success", TaskState.FAILED: "failure", TaskState.ERROR: "failure"}
_PHRASES = {"success": "succeeded", "failure": "failed", "skipped": "had nothing to do", "stopped": "was stopped"}
OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
_OF_A_TASK = ("id", "state", "priority", "mission", "person", "labels", "waits")
_PERIOD = 1.0  # seconds between two diagnostics
_TREE_PAUSE = 1.0  # seconds of real time between two snapshots while statuses change


class RunUpdate(Record):
    """Statuses of nodes by path at a time of the mission, and the words of the running commands.

    `is_last` is true when the run is over.
    """

    time: float
    running: str
    statuses: Mapping[str, int]
    is_last: bool = False


class MissionProgress:
    """A sink that passes on the nodes with a new status, at most once a tick, and now and then and at the end all
    nodes.

    `snapshot` is that of the run. The other functions are called in the thread of the run, and at its end.
    """

    policy = INLINE

    def __init__(
        self,
        snapshot: Callable[[], Snapshot],
        changed: Callable[[RunUpdate], object],
        reached: Callable[[RunUpdate], object],
    ) -> None:
        self._snapshot, self._changed, self._reached = snapshot, changed, reached
        self._new: dict[str, int] = {}
        self._pending = False
        self._reached_at = -_PAUSE

    def __call__(self, event: Event) -> None:
        if isinstance(event, StatusesChanged):
            for change in event:
                self._new[change.path] = change.status
        elif isinstance(event, PeriodPassed):
            self._report(time.monotonic() - self._reached_at >= _PAUSE)
        elif isinstance(event, Ended):
            self._report(True, is_last=True)

    def _report(self, all_too: bool, *, is_last: bool = False) -> None:
        if not (is_last or self._new or (self._pending and all_too)):
            return
        now = self._snapshot()
        running = "; ".join(now.running)
        if self._new:
            self._changed(RunUpdate(now.t, running, self._new))
            self._new, self._pending = {}, True
        if all_too:
            self._pending, self._reached_at = False, time.monotonic()
            self._reached(RunUpdate(now.t, running, now.statuses, is_last))


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


class TreeTopic:
    """The tree of a run as a snapshot and changes; `snapshot` and `changes` publish a text.

    Both have the id of the run and a `sequence`, which counts the changes: a snapshot includes those up to its own. So
    a late listener applies only later ones, and notices if one was lost.
    """

    def __init__(
        self, mission: Mission, run: Run, snapshot: Callable[[str], object], changes: Callable[[str], object]
    ) -> None:
        self._snapshot, self._changes = snapshot, changes
        nodes = [
            {"path": path, "id": node.id, "words": mission.label(node), "ports": dict(node.ports)}
            for path, node in run.nodes.nodes
        ]
        self._head = {"run": run.id, "outline": str(mission), "nodes": nodes}
        self._sequence = 0
        self._published_at = time.monotonic()
        self._snapshot(json.dumps({**self._head, "sequence": 0, "time": 0.0, "statuses": {}}))

    def publish_changes(self, news: RunUpdate) -> None:
        """Publish the nodes with a new status."""
        self._sequence += 1
        changes = {
            "run": self._head["run"],
            "sequence": self._sequence,
            "time": news.time,
            "changes": _status_names(news),
        }
        self._changes(json.dumps(changes))

    def publish_snapshot(self, news: RunUpdate, *, is_last: bool = False) -> None:
        """Publish all nodes that were reached."""
        now = time.monotonic()
        if is_last or now >= self._published_at + _TREE_PAUSE:
            self._published_at = now
            state = {"sequence": self._sequence, "time": news.time, "statuses": _status_names(news)}
            self._snapshot(json.dumps({**self._head, **state}))


def _status_names(news: RunUpdate) -> dict[str, str]:
    return {path: NAMES[status] for path, status in news.statuses.items()}

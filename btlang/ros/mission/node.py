"""The lifecycle node of a robot with its task layer: its setup, its missions, and the node of its emergency stop."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress

from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.node import Node
from std_srvs.srv import Trigger

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.ros.mission.progress import MissionProgress, RunUpdate, TreeTopic
from btlang.ros.mission.server import LABEL, MissionServer, create_services
from btlang.ros.mission.setup import Setup
from btlang.ros.mission.topics import ERROR, OK, WARN, MissionReport, Topics, report_of
from btlang.run.logs import PlainLines
from btlang.task import messages
from btlang.task.execution.emergency import shut_latch
from btlang.task.layer import TaskLayer
from btlang.task.live.task_follower import TaskFollower
from btlang.task.messages import Answer, Command
from btlang.task.store.records import ACTIVE, FINAL, WAITING, MissionText, Task, TaskChange, TaskState

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.events import Sink
    from btlang.session import Run

_SUCCESS, _FAILURE = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE
_PERSON = "ROS 2"
_MOST = 1000  # tasks on ~/tasks
_OWN = "node"
"""The label of the node's own mission."""


class StopNode(Node):  # type: ignore[misc]  # rclpy is seen as untyped
    """A node with the emergency stop. `service` is the full name of its service; `stop` returns whether there was a
    robot to stop.
    """

    def __init__(self, service: str, stop: Callable[[], bool], name: str, **options: Any) -> None:
        super().__init__(name, start_parameter_services=False, enable_rosout=False, **options)
        self._do = stop
        self.create_service(Trigger, service, self._stop)

    def _stop(self, request: Any, response: Any) -> Any:
        response.success = self._do()
        response.message = "" if response.success else "there is no robot, and its latch can't be written"
        return response


class MissionNode(LifecycleNode):  # type: ignore[misc]  # rclpy is seen as untyped
    """A lifecycle node for the missions of a robot. Its callbacks run in one thread, missions in another.

    configure reads the mission of the parameters `mission` or `mission_file` and connects to the robot; activate runs
    it, and then the tasks that are due; deactivate halts them; cleanup disconnects from the robot. `error` is the
    reason why configuring failed; `down` ends the process.
    """

    def __init__(
        self, setup: Setup, show: Callable[[str], object], down: Callable[[], object], name: str, **options: Any
    ) -> None:
        super().__init__(name, **options)
        self._setup, self._down = setup, down
        self._layer: TaskLayer | None = None
        self._follower: TaskFollower | None = None
        self._mission: MissionText | None = None
        self._latest: MissionReport | None = None
        self._seconds: dict[int, float] = {}
        self._running = ""
        self._active = False
        self.error: MissionError | None = None
        self.declare_parameter("mission", "")
        self.declare_parameter("mission_file", setup.file)
        self._topics = Topics(self, show, self._health)
        create_services(self, self.answer)
        self._server = MissionServer(self, self._hindrance, self.answer, self._topics.complain)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the mission and connect to the robot. Fails if either isn't possible; the log has the reason."""
        text, file = (str(self.get_parameter(name).value) for name in ("mission", "mission_file"))
        try:
            reader = self._setup.reader()
            self._mission = self._setup.mission(text, file, reader)
            if self._mission is not None:
                reader.read(self._mission)
            self._layer = self._setup.task_layer(
                reader, trouble=self._topics.complain, down=self._down, sinks=self._sinks
            )
        except MissionError as error:
            self.error = error
            self._topics.complain(str(error))
            return _FAILURE
        self._end_tasks(WAITING, "its node ended before it did")
        self._follower = TaskFollower(self._layer.store, self._on_change, self._topics.complain)
        self._topics.tasks(self.answer(messages.List(limit=_MOST)))
        return _SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run the mission of the parameters, if there is one, and accept missions of others from now on."""
        assert self._layer is not None
        try:
            if self._mission is not None:
                self._layer.add(self._mission, _PERSON, labels=(_OWN,))
        except MissionError as error:  # the missions of others may do better
            self._topics.complain(str(error))
        try:
            self._layer.start()
        except MissionError as error:
            self._topics.complain(str(error))
            return _FAILURE
        self._active = True
        return _SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Wait until the robot stands still. Fails if a command hangs; the robot is stopped all the same."""
        return _SUCCESS if self.halt() else _FAILURE

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Disconnect from the robot."""
        self.release()
        return _SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivate and clean up."""
        self.halt()
        self.release()
        return _SUCCESS

    def _LifecycleNodeMixin__on_change_state(self, request: Any, response: Any) -> Any:
        """Answer every request: rclpy doesn't if there's no such transition, and a lifecycle manager then waits
        forever.
        """
        try:
            return super()._LifecycleNodeMixin__on_change_state(request, response)
        except RuntimeError as error:
            self._topics.complain(f"no such transition now: {str(error).partition(',')[0]}")
            response.success = False
            return response

    def halt(self) -> bool:
        """Cancel all goals and the node's own mission, and halt what else runs; return whether it ended. For any
        thread.
        """
        layer, was_active = self._layer, self._active
        if layer is None:
            return True
        self._active = False
        self._end_tasks(WAITING | ACTIVE, "the node was deactivated")
        ended = layer.halt()
        self._active = was_active and not ended
        return ended

    def release(self) -> None:
        """Disconnect from the robot, which is left at rest. May be called twice."""
        layer, self._layer = self._layer, None
        if layer is not None:
            if self._follower is not None:
                self._follower.close()
            layer.close()

    def emergency_stop(self, person: str = _PERSON) -> bool:
        """Stop the robot at once until it is released, from any thread.

        Before the node is configured, keep the robot stopped from then on. Returns False if even that can't be written
        down.
        """
        layer = self._layer
        if layer is not None:
            layer.stop(person)
            return True
        folder = self._setup.layer["folder"]
        with suppress(OSError):
            os.makedirs(folder, mode=0o700, exist_ok=True)
            shut_latch(folder, person)
            return True
        return False

    def disable(self) -> None:
        """Stop the robot, if there is one, without a latch; from any thread."""
        if self._layer is not None:
            self._layer.disable()

    def answer(self, command: Command | dict[str, Any], person: str = _PERSON) -> Answer:
        """Do a command of the task layer. For any thread."""
        layer = self._layer
        if layer is None:
            return Answer(False, "There is no robot: the node is not configured.")
        return layer.handle(command, person)

    def watch(self, *wanted: Any) -> Generator[dict[str, Any]]:
        """Follow the events of the robot (see `btlang.task.live.feed.Feed.watch`); no events without a robot."""
        if self._layer is not None:
            yield from self._layer.feed.watch(*wanted)

    def _end_tasks(self, states: frozenset[TaskState], reason: str) -> None:
        """End the tasks that don't outlive the node's work: those of goals, and its own."""
        assert self._layer is not None
        for label in (LABEL, _OWN):
            for task in self._layer.store.tasks(states, label=label):
                self.answer(messages.Cancel(task.id, reason))

    def _hindrance(self) -> str:
        """Return why the node accepts no mission now; "" if it does."""
        return "" if self._active else "the node is not active"

    def _sinks(self, task: Task | None, mission: Mission, run: Run) -> list[Sink]:
        if task is None:
            return []
        tree = TreeTopic(mission, run, self._topics.tree, self._topics.tree_changes)

        def changed(news: RunUpdate) -> None:
            self._running, self._seconds[task.id] = news.running, news.time
            tree.publish_changes(news)
            self._server.news(task.id, news)

        def reached(news: RunUpdate) -> None:
            tree.publish_snapshot(news, is_last=news.is_last)
            self._topics.status(news)

        return [
            PlainLines(mission.label, mission.is_action, self._topics.log),
            MissionProgress(run.snapshot, changed, reached),
        ]

    def _on_change(self, changes: Sequence[TaskChange]) -> None:
        """Publish a change of tasks, in the thread of the follower."""
        layer = self._layer
        if layer is None:
            return
        listed = self.answer(messages.List(limit=_MOST))
        waits = {task["id"]: task["waits"] for task in listed.data.get("tasks", ())}
        self._topics.tasks(listed)
        for change in changes:
            data = {"id": change.task, "state": change.state, "waits": waits.get(change.task, "")}
            if change.state not in FINAL:
                self._server.changed(data, None)
                continue
            task = layer.store.task(change.task)
            if task is not None:
                self._latest = report_of(task, self._seconds.pop(task.id, 0.0))
                self._running = ""
                self._topics.log(f"task {task.id}: {self._latest}")
                self._server.changed(data, self._latest)

    def _health(self) -> tuple[bytes, str, dict[str, str]]:
        values = {"robot": self._setup.robot, "active": str(self._active), "running": self._running}
        layer = self._layer
        if layer is None:
            return WARN, "not configured", values
        if layer.executor.task is not None:
            return OK, "a mission is running", values
        if layer.emergency.is_latched:
            return ERROR, f"the robot is stopped: {layer.emergency.reason}", values
        if self._latest is None:
            return OK, "no mission has run yet", values
        level = ERROR if self._latest.outcome == "failure" else OK
        first, _, rest = str(self._latest).partition("\n")
        return level, first, {**values, "details": rest}

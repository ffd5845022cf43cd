"""The lifecycle node of a robot with its task layer: runs its own mission, and those that other programs send."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress

from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn

from btlang.api import Mission
from btlang.diagnostics.errors import MissionError
from btlang.ros.mission.progress import News, Progress
from btlang.ros.mission.report import Report, report_of
from btlang.ros.mission.server import LABEL, MissionServer
from btlang.ros.mission.services import create_services
from btlang.ros.mission.setup import Setup
from btlang.ros.mission.topics import ERROR, OK, WARN, Topics
from btlang.ros.mission.tree_topic import TreeTopic
from btlang.run.logs import PlainLines
from btlang.task import messages
from btlang.task.execution.emergency import shut_latch
from btlang.task.live.feed import TaskFollower
from btlang.task.messages import Answer, Command
from btlang.task.store.records import ACTIVE, FINAL, WAITING, MissionText, Task, TaskChange, TaskState

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.events import Sink
    from btlang.session import Run
    from btlang.task.layer import TaskLayer

_SUCCESS, _FAILURE = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE
_PERSON = "ROS 2"
_MOST = 1000  # tasks on ~/tasks
_OWN = "node"
"""The label of the node's own mission."""


class MissionNode(LifecycleNode):  # type: ignore[misc]  # rclpy is seen as untyped
    """configure reads the mission of the parameters `mission` or `mission_file` and reaches for the robot; activate
    runs it, and then the tasks that are due; deactivate halts them; cleanup lets go of the robot.

    All of its callbacks are called in one thread; missions run in another. `error` is why configuring failed, `down`
    ends the process.
    """

    def __init__(
        self, setup: Setup, show: Callable[[str], object], down: Callable[[], object], name: str, **options: Any
    ) -> None:
        super().__init__(name, **options)
        self._setup, self._down = setup, down
        self._layer: TaskLayer | None = None
        self._follower: TaskFollower | None = None
        self._mission: MissionText | None = None
        self._latest: Report | None = None
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
        """Fails where the mission cannot be read or the robot cannot be reached; the log says why."""
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
        self._follower = TaskFollower(self._layer.store, self._changed, self._topics.complain)
        self._topics.tasks(self.answer(messages.List(limit=_MOST)))
        return _SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Runs the mission of the parameters where there is one; from now on takes missions of others."""
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
        """Waits until the robot stands still. Fails where a command hangs; the robot is stopped all the same."""
        return _SUCCESS if self.halt() else _FAILURE

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Lets go of the robot."""
        self.release()
        return _SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """As deactivate and cleanup."""
        self.halt()
        self.release()
        return _SUCCESS

    def _LifecycleNodeMixin__on_change_state(self, request: Any, response: Any) -> Any:
        """rclpy's own one answers nothing where there is no such transition, and a lifecycle manager waits for ever."""
        try:
            return super()._LifecycleNodeMixin__on_change_state(request, response)
        except RuntimeError as error:
            self._topics.complain(f"no such transition now: {str(error).partition(',')[0]}")
            response.success = False
            return response

    def halt(self) -> bool:
        """Cancels all goals and the node's own mission, and halts what else runs; whether it ended. From any thread."""
        layer, was_active = self._layer, self._active
        if layer is None:
            return True
        self._active = False
        self._end_tasks(WAITING | ACTIVE, "the node was deactivated")
        ended = layer.halt()
        self._active = was_active and not ended
        return ended

    def release(self) -> None:
        """Lets go of the robot, at rest. May be called twice."""
        layer, self._layer = self._layer, None
        if layer is not None:
            if self._follower is not None:
                self._follower.close()
            layer.close()

    def emergency_stop(self, person: str = _PERSON) -> bool:
        """Stops the robot at once until it is released, from any thread, or keeps it stopped from when it is configured
        on; False where even that can't be written down.
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
        """Stops the robot where there is one, without a latch; from any thread."""
        if self._layer is not None:
            self._layer.disable()

    def answer(self, command: Command | dict[str, Any], person: str = _PERSON) -> Answer:
        """Does a command. From any thread."""
        layer = self._layer
        if layer is None:
            return Answer(False, "There is no robot: the node is not configured.")
        return layer.handle(command, person)

    def watch(self, *wanted: Any) -> Generator[dict[str, Any]]:
        """What happens on the robot (see `btlang.task.live.feed.Feed.watch`); nothing if there is none."""
        if self._layer is not None:
            yield from self._layer.feed.watch(*wanted)

    def _end_tasks(self, states: frozenset[TaskState], reason: str) -> None:
        """Those that don't outlive the node's work: of goals, and its own."""
        assert self._layer is not None
        for label in (LABEL, _OWN):
            for task in self._layer.store.tasks(states, label=label):
                self.answer(messages.Cancel(task.id, reason))

    def _hindrance(self) -> str:
        """Why no mission is taken now; "" where one is."""
        return "" if self._active else "the node is not active"

    def _sinks(self, task: Task | None, mission: Mission, run: Run) -> list[Sink]:
        if task is None:
            return []
        tree = TreeTopic(mission, run, self._topics.tree, self._topics.tree_changes)

        def changed(news: News) -> None:
            self._running, self._seconds[task.id] = news.running, news.time
            tree.changed(news)
            self._server.news(task.id, news)

        def reached(news: News) -> None:
            tree.reached(news, is_last=news.is_last)
            self._topics.status(news)

        return [
            PlainLines(mission.label, mission.is_action, self._topics.log),
            Progress(run.snapshot, changed, reached),
        ]

    def _changed(self, changes: Sequence[TaskChange]) -> None:
        """In the thread of the follower."""
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

"""The action server that queues missions of other programs as tasks, and the services for commands."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from btlang_interfaces.action import RunMission
from btlang_interfaces.srv import Command as CommandService
from btlang_interfaces.srv import TaskCommand
from rclpy.node import Node
from std_srvs.srv import Trigger

from btlang.ros.goals import GONE, GoalServer, HeldGoal
from btlang.ros.lease import Leases
from btlang.ros.mission.topics import MissionReport, fill_progress
from btlang.task import messages
from btlang.task.messages import Answer, Command
from btlang.text.json_text import load_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.ros.mission.progress import RunUpdate

    Handle = Callable[[Command | dict[str, Any]], Answer]

LABEL = "goal"
"""The label of tasks that live as long as their goals."""
_PLAIN = (
    messages.Pause, messages.Step, messages.Release, messages.Status, messages.Components, messages.InviteVisitor,
)  # fmt: skip
_OF_A_TASK = (
    messages.Cancel, messages.Kill, messages.Interrupt, messages.Resume, messages.Skip, messages.Again, messages.Show,
)  # fmt: skip


class MissionServer:
    """The action ~/run_mission for any number of goals, and none while `hindrance` gives a reason.

    Callbacks don't wait. `handle` does commands. A goal whose client or node ends is cancelled.
    """

    def __init__(
        self,
        node: Node,
        hindrance: Callable[[], str],
        handle: Callable[[Command], Answer],
        complain: Callable[[str], object],
    ) -> None:
        self._hindrance, self._handle, self._complain = hindrance, handle, complain
        self._goals: dict[int, HeldGoal] = {}
        self._tasks: dict[HeldGoal, int] = {}
        self._adding = threading.Lock()
        self._worker = ThreadPoolExecutor(1, "btlang goals")  # commands may take a moment
        GoalServer(node, RunMission, "~/run_mission", self._begin, Leases(node), self._accepts)

    def news(self, task: int, news: RunUpdate) -> None:
        """Send the progress of a task to its client."""
        goal = self._goals.get(task)
        if goal is not None:
            goal.publish_feedback(fill_progress(RunMission.Feedback(task=task, state="underway"), news))

    def changed(self, data: dict[str, Any], report: MissionReport | None) -> None:
        """Take a change of a task's state: `data` as in answers, and the report if the task is over."""
        with self._adding:
            goal = self._goals.get(data["id"])
        if goal is None:
            return
        if report is None:
            goal.publish_feedback(RunMission.Feedback(task=data["id"], state=data["state"], waits=data["waits"]))
        else:
            self._end(data["id"], report)

    def _accepts(self) -> bool:
        reason = self._hindrance()
        if reason:
            self._complain(f"mission rejected: {reason}")
        return not reason

    def _begin(self, goal: HeldGoal) -> Callable[[str], object]:
        self._worker.submit(self._add, goal)
        return lambda reason: self._worker.submit(self._cancel, goal, reason)

    def _add(self, goal: HeldGoal) -> None:
        request = goal.request
        command = messages.Submit(
            request.mission, keywords=tuple(request.keywords), priority=request.priority, labels=(LABEL,)
        )
        with self._adding:  # its end may come before this one has its number
            answer = self._handle(command)
            if answer.ok:
                task = answer.data["task"]["id"]
                self._goals[task], self._tasks[goal] = goal, task
        if not answer.ok:
            goal.end(False, _result(0, MissionReport("failure", answer.text)))

    def _cancel(self, goal: HeldGoal, reason: str) -> None:
        task = self._tasks.get(goal)
        if task is not None:
            if reason == GONE:
                self._complain(f"mission halted: {reason}")
            self._handle(messages.Cancel(task, reason))

    def _end(self, task: int, report: MissionReport) -> None:
        goal = self._goals.pop(task)
        self._tasks.pop(goal)
        goal.end(report.success, _result(task, report))


def _result(task: int, report: MissionReport) -> Any:
    return RunMission.Result(
        success=report.success, outcome=report.outcome, reason=report.reason, seconds=report.seconds, task=task
    )


def create_services(node: Node, handle: Handle) -> None:
    """Create `~/pause`, `~/cancel` and so on, and `~/command` for all commands as JSON; `handle` does them."""
    for kind in _PLAIN:
        node.create_service(Trigger, f"~/{kind.tag}", partial(_answer_plain, kind, handle))
    for each in _OF_A_TASK:
        node.create_service(TaskCommand, f"~/{each.tag}", partial(_of_a_task, each, handle))
    node.create_service(CommandService, "~/command", partial(_any, handle))


def _answer_plain(kind: type[Command], handle: Handle, request: Any, response: Any) -> Any:
    answer = handle(kind())
    response.success, response.message = answer.ok, answer.text
    return response


def _of_a_task(kind: type[Command], handle: Handle, request: Any, response: Any) -> Any:
    return _fill_response(response, handle(kind(**{field: getattr(request, field) for field in kind.fields})))


def _any(handle: Handle, request: Any, response: Any) -> Any:
    try:
        data = load_json(request.command)
    except ValueError:
        return _fill_response(response, Answer(False, "That isn't JSON.", {}, "BT198"))
    return _fill_response(response, handle(data))


def _fill_response(response: Any, answer: Answer) -> Any:
    response.ok, response.text, response.code = answer.ok, answer.text, answer.code
    response.data = json.dumps(dict(answer.data), ensure_ascii=False, default=str)
    return response

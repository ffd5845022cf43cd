"""The action server that runs the missions of other programs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from btlang_interfaces.action import RunMission
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import GoalEvent
from rclpy.node import Node

from btlang.ros.mission.run import MissionRun, Report
from btlang.ros.mission.topics import filled

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.ros.mission.progress import News


class MissionServer:
    """~/run_mission: one goal at a time, none while `hindrance` gives a reason. Callbacks wait for nothing.

    `begin` runs the mission of a goal; it tells the news of it and, at its end, the report.
    """

    def __init__(
        self,
        node: Node,
        hindrance: Callable[[], str],
        begin: Callable[[Any, Callable[[News], object], Callable[[Report], object]], MissionRun],
        rejected: Callable[[str], object],
    ) -> None:
        self._hindrance, self._begin, self._rejected = hindrance, begin, rejected
        self._runs: dict[bytes, MissionRun] = {}
        self._server = ActionServer(
            node,
            RunMission,
            "~/run_mission",
            execute_callback=lambda goal: RunMission.Result(),
            goal_callback=self._consider,
            handle_accepted_callback=self._accept,
            cancel_callback=self._cancel,
        )

    def _consider(self, request: Any) -> GoalResponse:
        reason = self._hindrance()
        if not reason:
            return GoalResponse.ACCEPT
        self._rejected(f"a mission is rejected: {reason}")
        return GoalResponse.REJECT

    def _accept(self, goal: Any) -> None:
        # goal.execute() would occupy the executor until the mission ends: the goal only says that it executes
        goal._update_state(GoalEvent.EXECUTE)

        def changed(news: News) -> None:
            goal.publish_feedback(filled(RunMission.Feedback(), news))

        def ended(report: Report) -> None:
            self._server.notify_execute(goal, partial(self._finish, report))

        self._runs[bytes(goal.goal_id.uuid)] = self._begin(goal.request, changed, ended)

    def _cancel(self, goal: Any) -> CancelResponse:
        run = self._runs.get(bytes(goal.goal_id.uuid))
        if run is not None:
            run.stop()
        return CancelResponse.ACCEPT

    def _finish(self, report: Report, goal: Any) -> Any:
        """In the thread of the executor, after the cancelling of the goal was answered."""
        self._runs.pop(bytes(goal.goal_id.uuid), None)
        if report.success:
            goal.succeed()
        elif goal.is_cancel_requested:
            goal.canceled()
        else:
            goal.abort()
        return RunMission.Result(
            success=report.success, outcome=report.outcome, reason=report.reason, seconds=report.seconds
        )

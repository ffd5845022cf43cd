"""The action server that runs the missions of other programs."""

from __future__ import annotations

from collections.abc import Callable

from btlang_interfaces.action import RunMission
from rclpy.node import Node

from btlang.ros.goals import GONE, GoalServer, HeldGoal
from btlang.ros.lease import Leases
from btlang.ros.mission.thread import MissionThread, Report
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
        begin: Callable[[Any, Callable[[News], object], Callable[[Report], object]], MissionThread],
        rejected: Callable[[str], object],
    ) -> None:
        self._hindrance, self._begin, self._rejected = hindrance, begin, rejected
        GoalServer(node, RunMission, "~/run_mission", self._run, Leases(node), self._accepts)

    def _accepts(self) -> bool:
        reason = self._hindrance()
        if reason:
            self._rejected(f"mission rejected: {reason}")
        return not reason

    def _run(self, goal: HeldGoal) -> Callable[[str], object]:
        def changed(news: News) -> None:
            goal.tell(filled(RunMission.Feedback(), news))

        def ended(report: Report) -> None:
            result = RunMission.Result(
                success=report.success, outcome=report.outcome, reason=report.reason, seconds=report.seconds
            )
            goal.end(report.success, result)

        run = self._begin(goal.request, changed, ended)

        def cancel(reason: str) -> None:
            if reason == GONE:
                self._rejected(f"mission halted: {reason}")
            run.stop()

        return cancel

"""The action servers /dock_robot and /undock_robot: drive into the dock and out of it, as those of Nav2 do."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nav2_msgs.action import DockRobot, UndockRobot
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node

from btlang.actions.motion import Steps
from btlang.actions.power import APPROACH, CONNECTION, RETRY, STAGING, enter_dock, undock
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import Station
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.ros.lease import Leases
from btlang.ros.messages import duration, pose_of
from btlang.ros.simulator.base import BaseTopics
from btlang.ros.simulator.navigation import refusal
from btlang.ros.simulator.shared import AcceptedGoal, CallQueue, Moment

_NEAR = 0.5  # metres from the dock at which a goal means it
_STATES = {
    STAGING: DockRobot.Feedback.NAV_TO_STAGING_POSE,
    APPROACH: DockRobot.Feedback.CONTROLLING,
    CONNECTION: DockRobot.Feedback.WAIT_FOR_CHARGE,
    RETRY: DockRobot.Feedback.RETRY,
}
_CODES = {
    STAGING: DockRobot.Result.FAILED_TO_STAGE,
    APPROACH: DockRobot.Result.FAILED_TO_CONTROL,
    CONNECTION: DockRobot.Result.FAILED_TO_CHARGE,
    RETRY: DockRobot.Result.FAILED_TO_CONTROL,
}


def _find_dock(request: Any, stations: list[Station]) -> Station:
    """Return the dock that a request means: by its name, or the nearest to a pose."""
    if request.use_dock_id:
        return next(station for station in stations if station.name == request.dock_id)
    pose = pose_of(request.dock_pose.pose)
    return min(stations, key=lambda station: pose.distance_to((station.spot.x, station.spot.y)))


class DockingGoal(AcceptedGoal):
    """A goal to dock or to undock. `code` is Nav2's code of its failure."""

    def __init__(self, node: Node, handle: ServerGoalHandle, docks: bool) -> None:
        super().__init__(node, handle)
        self.docks = docks
        self.steps: Steps | None = None
        self.code = 0
        self.stage = ""
        self.retries = 0

    def fail(self, failure: str, code: int) -> None:
        """End the goal, unless it has ended: the robot brakes."""
        if self.failure is None:
            self.failure, self.code = failure, code
        if self.steps is not None:
            self.steps.close()

    def result(self) -> Any:
        """Return the result for the client."""
        if not self.docks:
            return UndockRobot.Result(success=self.failure is None, error_code=self.code, error_msg=self.failure or "")
        return DockRobot.Result(
            success=self.failure is None, error_code=self.code, error_msg=self.failure or "", num_retries=self.retries
        )


class DockingServer:
    """One goal at a time; a new one replaces the current one, which is aborted."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue, wheels: BaseTopics) -> None:
        self._node, self._robot, self._calls, self._wheels = node, robot, calls, wheels
        self._goal: DockingGoal | None = None
        self._leases = Leases(node)
        for kind, name, docks in ((DockRobot, "dock_robot", True), (UndockRobot, "undock_robot", False)):
            ActionServer(node, kind, name, self._execute(docks), cancel_callback=lambda goal: CancelResponse.ACCEPT)

    def publish(self, now: Moment) -> None:
        """Go on with the current goal, and publish the stages of docking."""
        goal = self._goal
        if goal is None or goal.steps is None:
            return
        if goal.is_withdrawn(now.seconds):
            goal.fail("docking was cancelled" if goal.docks else "undocking was cancelled", DockRobot.Result.UNKNOWN)
        elif goal.cancelled is None and self._wheels.driven:
            goal.fail("another command took over the drive", DockRobot.Result.FAILED_TO_CONTROL)
        if goal.failure is None:
            try:
                next(goal.steps)
                return
            except StopIteration:
                pass
            except ActionFailed as problem:
                goal.fail(str(problem), _CODES.get(goal.stage, DockRobot.Result.FAILED_TO_CONTROL))
        if not goal.brakes(now.seconds, self._robot):
            self._goal = None
            goal.end()

    def _execute(self, docks: bool) -> Callable[[ServerGoalHandle], Any]:
        async def execute(handle: ServerGoalHandle) -> Any:
            """Run a goal, in the thread of the executor."""
            goal = DockingGoal(self._node, handle, docks)
            self._calls.post(lambda: self._begin(goal))
            await goal.wait_for_end(self._leases)
            return goal.result()

        return execute

    def _begin(self, goal: DockingGoal) -> None:
        refused = self._refusal(goal.handle.request) if goal.docks and not self._robot.docked else None
        if refused is not None:
            goal.fail(*refused)
            goal.end()
            return
        if self._goal is not None:
            self._goal.fail("the robot docks instead" if goal.docks else "the robot undocks instead", 999)
            self._goal.end()
        self._wheels.leave()
        self._goal, goal.began = goal, self._robot.time
        goal.steps = self._dock(goal) if goal.docks else undock(self._robot)

    def _dock(self, goal: DockingGoal) -> Steps:
        if not self._robot.docked:
            station = _find_dock(goal.handle.request, self._robot.stations)
            yield from enter_dock(self._robot, station, lambda stage: self._publish_feedback(goal, stage))

    def _refusal(self, request: Any) -> tuple[str, int] | None:
        """Return why it can't dock as requested, with a code."""
        names = [dock.name for dock in self._robot.world.all_docks]
        if not names:
            return "there is no dock in this world", DockRobot.Result.DOCK_NOT_IN_DB
        if request.use_dock_id and request.dock_id not in names:
            only = " and ".join(f'"{name}"' for name in names)
            return f'there is no dock "{request.dock_id}", only {only}', DockRobot.Result.DOCK_NOT_IN_DB
        pose = pose_of(request.dock_pose.pose)
        if not request.use_dock_id and (wrong := refusal(request.dock_pose.header.frame_id, pose)):
            return wrong, DockRobot.Result.DOCK_NOT_VALID
        station, at = _find_dock(request, self._robot.stations), self._robot.pose
        if not request.use_dock_id and pose.distance_to((station.spot.x, station.spot.y)) > _NEAR:
            return f"there is no dock at ({pose.x:.2f}, {pose.y:.2f})", DockRobot.Result.FAILED_TO_DETECT_DOCK
        if not request.navigate_to_staging_pose and station.staging.distance_to((at.x, at.y)) > _NEAR:
            return "the robot isn't in front of the dock", DockRobot.Result.FAILED_TO_STAGE
        return None

    def _publish_feedback(self, goal: DockingGoal, stage: str) -> None:
        goal.stage = stage
        goal.retries += stage == RETRY
        feedback = DockRobot.Feedback(state=_STATES[stage], num_retries=goal.retries)
        feedback.docking_time = duration(self._robot.time - goal.began)
        goal.handle.publish_feedback(feedback)

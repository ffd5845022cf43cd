"""The action servers that drive: /navigate_to_pose, /dock_robot and /undock_robot, as those of Nav2 do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from typing import Any

from nav2_msgs.action import DockRobot, NavigateToPose, UndockRobot
from nav2_msgs.msg import SpeedLimit
from nav_msgs.msg import Path
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node

from btlang.actions.motion import Steps
from btlang.actions.power import APPROACH, CONNECTION, RETRY, STAGING, enter_dock, undock
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import Station
from btlang.robots.simulation.navigation import NavigationGoal
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.ros.lease import Leases
from btlang.ros.messages import MAP, ODOM, duration, pose_message, pose_of, stamped_pose
from btlang.ros.robot.zones import SPEED_LIMIT
from btlang.ros.simulator.base import BaseTopics
from btlang.ros.simulator.shared import COMMANDS, AcceptedGoal, CallQueue, Moment, PeriodicPublisher

FAILED = 9000
"""The error code of all that can go wrong, as of Nav2 for what it has no own code for; `error_msg` says what it is."""


class NavigationRide(AcceptedGoal):
    """A goal to navigate to a pose; one that no robot can reach fails at once."""

    def __init__(self, node: Node, handle: ServerGoalHandle) -> None:
        super().__init__(node, handle)
        self.pose = pose_of(handle.request.pose.pose)
        self.failure = refusal(handle.request.pose.header.frame_id, self.pose)
        self.navigation: NavigationGoal | None = None
        self.feedback = PeriodicPublisher(5)

    def end(self) -> None:
        """End the goal with its navigation."""
        if self.navigation is not None:
            self.failure = self.navigation.failure
        super().end()


class NavigationServer:
    """One goal at a time; a new one replaces the current one, which is aborted."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue, wheels: BaseTopics) -> None:
        self._node = node
        self._robot = robot
        self._calls = calls
        self._wheels = wheels
        self._ride: NavigationRide | None = None
        self._plan = node.create_publisher(Path, "plan", COMMANDS)
        self._way: Sequence[Point] = ()
        self._leases = Leases(node)
        node.create_subscription(
            SpeedLimit, SPEED_LIMIT, lambda limit: calls.post(lambda: self._limit(limit)), COMMANDS
        )
        ActionServer(
            node,
            NavigateToPose,
            "navigate_to_pose",
            self._execute,
            cancel_callback=lambda goal: CancelResponse.ACCEPT,
        )

    def publish(self, now: Moment) -> None:
        """Publish the plan, the progress of the goal, or its end."""
        self._publish_plan(now)
        ride = self._ride
        if ride is None or ride.navigation is None:
            return
        if ride.is_withdrawn(now.seconds):
            ride.navigation.cancel()
        if ride.navigation.done and not ride.brakes(now.seconds, self._robot):
            self._ride = None
            ride.end()
        elif ride.feedback.is_due(now.seconds):
            self._publish_feedback(ride, ride.navigation, now)

    def _publish_plan(self, now: Moment) -> None:
        """Publish each plan once."""
        way = self._robot.way
        if not way or way is self._way:
            return
        self._way = way
        plan = Path()
        plan.header.stamp, plan.header.frame_id = now.stamp, MAP
        plan.poses = [stamped_pose(Pose(*point), now.stamp) for point in way]
        self._plan.publish(plan)

    async def _execute(self, handle: ServerGoalHandle) -> NavigateToPose.Result:
        """Run a goal, in the thread of the executor."""
        ride = NavigationRide(self._node, handle)
        self._calls.post(lambda: self._begin(ride))
        await ride.finished(self._leases)
        if ride.failure is None:
            return NavigateToPose.Result()
        return NavigateToPose.Result(error_code=FAILED, error_msg=ride.failure)

    def _limit(self, limit: SpeedLimit) -> None:
        """Set the speed limit as in Nav2: a percentage, or metres a second; 0 for no limit."""
        share = limit.speed_limit / (100.0 if limit.percentage else self._robot.normal_speed)
        self._robot.pace = min(1.0, share) if share > 0.0 else 1.0

    def _begin(self, ride: NavigationRide) -> None:
        if ride.failure is not None:
            ride.end()
            return
        ride.navigation, ride.began = self._robot.navigate_to_pose(ride.pose), self._robot.time
        self._wheels.leave()
        if self._ride is not None:
            self._ride.end()  # the new goal has ended its own
        self._ride = ride

    def _publish_feedback(self, ride: NavigationRide, goal: NavigationGoal, now: Moment) -> None:
        left = goal.left
        feedback = NavigateToPose.Feedback(distance_remaining=left)
        feedback.current_pose.header.stamp, feedback.current_pose.header.frame_id = now.stamp, MAP
        feedback.current_pose.pose = pose_message(self._robot.pose)
        feedback.navigation_time = duration(now.seconds - ride.began)
        feedback.estimated_time_remaining = duration(left / self._robot.normal_speed)
        ride.handle.publish_feedback(feedback)


def refusal(frame: str, pose: Pose) -> str | None:
    """Return why a pose in a frame can't be a goal; None if it can."""
    if frame not in (MAP, ODOM, ""):
        return f"the goal is in the frame {frame}, and the robot knows only {MAP} and {ODOM}"
    if not all(map(isfinite, (pose.x, pose.y, pose.heading))):
        return "the goal is no pose: one of its numbers is infinite, or not a number"
    return None


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


def _wanted(request: Any, stations: list[Station]) -> Station:
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
            await goal.finished(self._leases)
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
            station = _wanted(goal.handle.request, self._robot.stations)
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
        station, at = _wanted(request, self._robot.stations), self._robot.pose
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

"""The action server /navigate_to_pose: drives to a pose on /plan, around obstacles, no faster than /speed_limit."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from nav2_msgs.action import NavigateToPose
from nav2_msgs.msg import SpeedLimit
from nav_msgs.msg import Path
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node

from btlang.robots.geometry import Point, Pose
from btlang.robots.simulation.navigation import NavigationGoal
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.ros.lease import Leases
from btlang.ros.messages import MAP, ODOM, duration, pose_message, pose_of, stamped_pose
from btlang.ros.robot.zones import SPEED_LIMIT
from btlang.ros.simulator.base import BaseTopics
from btlang.ros.simulator.shared import COMMANDS, AcceptedGoal, CallQueue, Moment, PeriodicPublisher

FAILED = 9000
"""Nav2's error code for all failures without a code of their own; `error_msg` has the reason."""


class AcceptedNavigation(AcceptedGoal):
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
        self._ride: AcceptedNavigation | None = None
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
        ride = AcceptedNavigation(self._node, handle)
        self._calls.post(lambda: self._begin(ride))
        await ride.wait_for_end(self._leases)
        if ride.failure is None:
            return NavigateToPose.Result()
        return NavigateToPose.Result(error_code=FAILED, error_msg=ride.failure)

    def _limit(self, limit: SpeedLimit) -> None:
        """Set the speed limit as in Nav2: a percentage, or metres a second; 0 for no limit."""
        share = limit.speed_limit / (100.0 if limit.percentage else self._robot.normal_speed)
        self._robot.pace = min(1.0, share) if share > 0.0 else 1.0

    def _begin(self, ride: AcceptedNavigation) -> None:
        if ride.failure is not None:
            ride.end()
            return
        ride.navigation, ride.began = self._robot.navigate_to_pose(ride.pose), self._robot.time
        self._wheels.leave()
        if self._ride is not None:
            self._ride.end()  # the new goal has ended its own
        self._ride = ride

    def _publish_feedback(self, ride: AcceptedNavigation, goal: NavigationGoal, now: Moment) -> None:
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

"""A goal of an action server of the simulator, which drives the robot."""

from __future__ import annotations

from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from btlang.robots.simulated import SimulatedRobot
from btlang.ros.lease import Leases

_BRAKING = 1.0  # simulated seconds that a cancelled goal waits at most until the robot stands still


class AcceptedGoal:
    """A goal that has been accepted; it sets out with the next step. `failure` is why it did not succeed."""

    def __init__(self, node: Node, handle: ServerGoalHandle) -> None:
        self._node, self.handle = node, handle
        self.failure: str | None = None
        self.began = 0.0
        self.cancelled: float | None = None
        """The second at which its client had withdrawn it."""
        self._abandoned = False
        self._ended = Future()

    async def finished(self, leases: Leases) -> None:
        """Waits for `end`, and reports how it ended; in the thread of the executor."""
        goal_id = bytes(self.handle.goal_id.uuid)
        leases.watch(goal_id, self._abandon)
        await self._ended
        leases.forget(goal_id)
        if self.failure is None:
            self.handle.succeed()
        elif self.handle.is_cancel_requested:
            self.handle.canceled()
        else:
            self.handle.abort()

    def end(self) -> None:
        """It is over."""
        self._ended.set_result(None)
        self._node.executor.wake()

    def is_withdrawn(self, now: float) -> bool:
        """Whether its client has cancelled it, or died, since the last call."""
        if self.cancelled is not None or not (self.handle.is_cancel_requested or self._abandoned):
            return False
        self.cancelled = now
        return True

    def brakes(self, now: float, robot: SimulatedRobot) -> bool:
        """Whether it was withdrawn and has to wait for the robot to stand still."""
        return self.cancelled is not None and now - self.cancelled < _BRAKING and robot.velocity != (0.0, 0.0)

    def _abandon(self) -> None:
        self._abandoned = True

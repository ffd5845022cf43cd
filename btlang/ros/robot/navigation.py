"""Goals of the servers that move a ROS 2 robot: to a pose by NavigateToPose, or to somebody who may walk."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from math import dist
from threading import Event, RLock
from typing import Any

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient
from rclpy.node import Node
from unique_identifier_msgs.msg import UUID

from btlang.engine.leaves.leaf import NotThere
from btlang.robots.bodies.body import TOLERANCE
from btlang.robots.geometry import Point, Pose, wrap
from btlang.robots.robot import RobotError
from btlang.robots.worlds.sight import Sight
from btlang.robots.worlds.world import said
from btlang.ros.clocks import AWAKE
from btlang.ros.goals import goal_handle
from btlang.ros.lease import Lease
from btlang.ros.messages import pose_of, stamped_pose
from btlang.ros.node import ExecutorThread
from btlang.ros.subscriptions import pose_fault
from btlang.support.record import Record

_SHOWS = 1.0  # seconds after a success in which the pose shows it
_SEEN = 0.3  # seconds after which odometry shows what the robot does
_SERVER = 2.0  # seconds that a server gets to be there
_ANSWER = 5.0  # seconds that it gets to accept or reject, and between two of its feedbacks
_MUTE, _STANDS = 15.0, 60.0  # seconds without any feedback, and with it, in which the robot does not move
_MOVED, _TURNED = 0.05, 5.0  # metres and degrees that it has to move
ACTION = "navigate_to_pose"
_WALKED = 0.5  # metres
_AGAIN = 2.0  # seconds between two goals


class GoalTask(Record):
    """A task for a server.

    It has the `sort` of server, the `name` of the target, and both in sentences, such as "the navigation to the lab",
    "navigate to the lab" and " on the way to the lab". `reasons` are those of its error codes. `regular` is whether it
    sends feedback repeatedly. The robot has to be within the `tolerance` of the `goal` at the end, in metres.
    """

    sort: str
    name: str
    noun: str
    verb: str
    way: str = ""
    reasons: Mapping[int, str] = {}
    regular: bool = True
    goal: Pose | None = None
    tolerance: float = math.inf


class ServerGoal:
    """One goal, as an Operation. `end` may be called from any thread.

    Nothing waits: `step` looks at what has come, so that a server that never answers costs the tick nothing. `spin`
    calls a function in the thread that spins, the only one that may use the client of an action: elsewhere an answer
    could come before the request is noted. `where` returns the pose of the robot, None if nobody knows it, and
    `localized` whether it comes from more than odometry: otherwise a pose that the server reports is preferred.
    """

    def __init__(
        self,
        task: GoalTask,
        client: Any,
        server: str,
        goal: Any,
        goal_id: UUID,
        spin: Callable[[Callable[[], None]], object],
        where: Callable[[], Pose | None],
        now: Callable[[], float],
        localized: Callable[[], bool] = lambda: True,
    ) -> None:
        self.name = task.name
        self.done = False
        self.failure: str | None = None
        self.withdrawn = Event()
        """Set when the server has given it up, or says that it will not."""
        self.pending = ""
        """Why the server may still drive the robot although its goal is withdrawn; "" where it does not."""
        self._client, self._goal, self._goal_id, self._spin = client, goal, goal_id, spin
        self._task = task
        self._server = f"{task.sort} server on {server}"
        self._lock = RLock()
        self._where, self._now, self._localized = where, now, localized
        self._succeeded_at: float | None = None
        self._since = AWAKE.now()  # of what it waits for now
        self._stood = (where(), now())
        self._sent = self._withdrawing = False
        self.heard = False
        """Whether the server has given feedback."""
        self._handle: Any = None
        self._result: Any = None
        self._reported: Pose | None = None

    def cancel(self) -> None:
        """Withdraw the goal."""
        self.end(f"{self._task.noun} was cancelled")

    def end(self, failure: str | None, *, withdraw: bool = True) -> None:
        """End the goal, as arrived or with the reason why not. Does nothing if it has ended."""
        with self._lock:
            if self.done:
                return
            self.failure = failure
            self.done = True
        if withdraw and self._sent:
            self.pending = f"the {self._task.sort} server did not answer the cancel"
            self._spin(self._withdraw)
        else:
            self.withdrawn.set()

    def step(self) -> None:
        """Go on with what has come since the last call."""
        if self.done:
            return
        if not self._sent:
            self._set_out()
        elif self._result is None:
            if self._waited(_ANSWER):
                self.end(NotThere(f"the {self._server} does not answer"))
        elif self._result.done():
            self._finish(self._result.result())
        elif not self._client.server_is_ready():
            self.end(NotThere(f"the {self._server} is gone"), withdraw=False)
        elif self.heard and self._task.regular and self._waited(_ANSWER):
            self.end(NotThere(f"no feedback from the {self._server} for {_ANSWER:g} s"))
        elif self._stands(seconds := _STANDS if self.heard or not self._task.regular else _MUTE):
            mute = "" if seconds == _STANDS else f", and the {self._server} sends no feedback"
            self.end(f"the robot has not moved for {seconds:g} s{self._task.way}{mute}")

    def _waited(self, limit: float) -> bool:
        return AWAKE.now() - self._since > limit

    def _stands(self, limit: float) -> bool:
        """Return whether the robot, or what the server reports of it, hasn't moved for so long."""
        before, since = self._stood
        now = self._where() or self._reported
        if now is not None and (
            before is None
            or before.distance_to((now.x, now.y)) > _MOVED
            or abs(wrap(now.heading - before.heading)) > _TURNED
        ):
            self._stood = now, self._now()
            return False
        return self._now() - since > limit

    def _set_out(self) -> None:
        if self._client.server_is_ready():
            self._sent, self._since = True, AWAKE.now()
            self._spin(self._send)
        elif self._waited(_SERVER):
            self.end(NotThere(f"no {self._server}"))

    def _finish(self, answer: Any) -> None:
        code, reached = answer.result.error_code, answer.status == GoalStatus.STATUS_SUCCEEDED
        if reached and not code:
            self._arrive()
            return
        task, gave_up = self._task, f"reported error {code}" if reached else "gave up"
        reason = task.reasons.get(code, f"the {task.sort} server {gave_up}{task.way}")
        if answer.status == GoalStatus.STATUS_CANCELED:
            reason = f"somebody cancelled {task.noun}"
        retries = getattr(answer.result, "num_retries", 0)
        again = f" ({retries} {'retry' if retries == 1 else 'retries'})" if retries else ""
        self.end((getattr(answer.result, "error_msg", "") or reason) + again, withdraw=False)

    def _arrive(self) -> None:
        """Take the server's success, if the robot is there. Its pose may come a moment later."""
        goal, at = self._task.goal, self._where() if self._localized() else self._reported or self._where()
        away = 0.0 if goal is None or at is None else at.distance_to((goal.x, goal.y))
        if self._succeeded_at is None:
            self._succeeded_at = AWAKE.now()
        if away <= self._task.tolerance:
            self.end(None, withdraw=False)
        elif AWAKE.now() - self._succeeded_at > _SHOWS:
            reason = f"the {self._task.sort} server reports success, but the robot is {away:.1f} m from the goal"
            self.end(reason, withdraw=False)

    # In the thread that spins
    def _send(self) -> None:
        sent = self._client.send_goal_async(self._goal, feedback_callback=self._hear, goal_uuid=self._goal_id)
        sent.add_done_callback(self._on_answer)

    def _hear(self, message: Any) -> None:
        self.heard, self._since = True, AWAKE.now()
        current = getattr(message.feedback, "current_pose", None)
        if current is not None and not pose_fault(current.pose):
            self._reported = pose_of(current.pose)

    def _on_answer(self, answer: Any) -> None:
        handle = answer.result()
        if not handle.accepted:
            self.end(f"the {self._task.sort} server refused to {self._task.verb}", withdraw=False)
            self._over()
            return
        self._since, self._stood = AWAKE.now(), (self._stood[0], self._now())
        if self._handle is None:
            self._follow(handle)
        if self.done:
            self._withdraw()

    def _follow(self, handle: Any) -> None:
        self._handle, self._result = handle, handle.get_result_async()
        self._result.add_done_callback(lambda _: self._over())

    def _withdraw(self) -> None:
        """Cancel a goal that may not be accepted yet by its id, and again once it is accepted."""
        if not self._withdrawing:  # the second answer would call it terminated
            self._withdrawing = True
            was_accepted = self._handle is not None
            handle = self._handle or goal_handle(self._client, self._goal_id)
            handle.cancel_goal_async().add_done_callback(lambda answer: self._on_cancel(answer.result(), was_accepted))

    def _on_cancel(self, response: CancelGoal.Response, was_accepted: bool) -> None:
        code = response.return_code
        if code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID and not was_accepted:
            self._withdrawing = False
            if self._handle is not None:  # it has been accepted in between
                self._withdraw()
            return
        if self._handle is None:
            self._follow(goal_handle(self._client, self._goal_id))
        if self._result.done() or code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID:
            self._over()
        elif response.goals_canceling or code == CancelGoal.Response.ERROR_GOAL_TERMINATED:  # its result comes, or not
            self.pending = f"the {self._task.sort} server did not end the cancelled goal"
        else:
            self.pending = f"the {self._task.sort} server refused to cancel its goal"
            self.withdrawn.set()

    def _over(self) -> None:
        """Note that the server does nothing more for the goal."""
        self.pending = ""
        self.withdrawn.set()


class ServerGoals:
    """The goals of one kind of server, and the current one. `stop` may be called from any thread."""

    def __init__(
        self,
        node: Node,
        executor: ExecutorThread,
        where: Callable[[], Pose | None],
        now: Callable[[], float],
        localized: Callable[[], bool] = lambda: True,
    ) -> None:
        self._node, self._executor = node, executor
        self._where, self._now, self._localized = where, now, localized
        self._lease = Lease(node)
        self._goal: ServerGoal | None = None
        self._stopped = -math.inf
        self._given_up: list[ServerGoal] = []

    def begin(self, task: GoalTask, client: Any, server: str, request: Any) -> ServerGoal:
        """Send a goal as a ServerGoal."""
        goal_id, spin = self._lease.goal_id(), self._executor.post
        self._goal = ServerGoal(task, client, server, request, goal_id, spin, self._where, self._now, self._localized)
        self._goal.step()
        return self._goal

    def stop(self, reason: str) -> None:
        """Withdraw the current goal, if there is one."""
        goal = self._goal
        if goal is not None and not goal.done:
            goal.end(reason)
            self._given_up.append(goal)
            self._stopped = AWAKE.now()

    def step(self) -> ServerGoal | None:
        """Go on; return the goal if it has ended since the last call."""
        goal = self._goal
        if goal is None:
            return None
        goal.step()
        if not goal.done:
            return None
        self._goal = None
        self._given_up = [earlier for earlier in dict.fromkeys((*self._given_up, goal)) if earlier.pending]
        return goal

    def pending(self) -> list[str]:
        """Return why the server may still drive the robot, for goals that were withdrawn."""
        return [goal.pending for goal in self._given_up if goal.pending]

    @property
    def has_just_stopped(self) -> bool:
        """Whether a goal was withdrawn so recently that nobody can know yet what became of the robot."""
        return AWAKE.now() - self._stopped < _SEEN

    def confirm_stop(self, seconds: float) -> None:
        """Wait so many seconds at most until the server has ended all goals that were withdrawn."""
        until = time.monotonic() + seconds
        for goal in (*self._given_up, *((self._goal,) if self._goal is not None else ())):
            goal.withdrawn.wait(max(0.0, until - time.monotonic()))


class RosNavigation(ServerGoals):
    """The client of the navigation server, and the current goal."""

    def __init__(
        self,
        node: Node,
        executor: ExecutorThread,
        where: Callable[[], Pose | None],
        now: Callable[[], float],
        localized: Callable[[], bool] = lambda: True,
        tolerance: float = TOLERANCE,
    ) -> None:
        from nav2_msgs.action import NavigateToPose  # a robot may have no Nav2

        super().__init__(node, executor, where, now, localized)
        self._tolerance = tolerance
        self._type = NavigateToPose
        self._client = ActionClient(node, NavigateToPose, ACTION)
        self._server = node.resolve_service_name(ACTION)

    def start(self, name: str, pose: Pose) -> ServerGoal:
        """Send a goal, and withdraw the current one."""
        self.stop(f"the robot set out for {said(name)} instead")
        goal = said(name)
        nouns = f"the navigation to {goal}", f"navigate to {goal}", f" on the way to {goal}"
        task = GoalTask("navigation", name, *nouns, goal=pose, tolerance=self._tolerance)
        request = self._type.Goal(pose=stamped_pose(pose, self._node.get_clock().now().to_msg()))
        return self.begin(task, self._client, self._server, request)


class Pursuit:
    """A navigation to somebody who may walk, as an Operation.

    `set_out` sends a goal for where the person was seen last; another one is sent if they are seen elsewhere. Raises
    what `set_out` does.
    """

    def __init__(self, name: str, sight: Sight, set_out: Callable[[], ServerGoal], now: float) -> None:
        self.done = False
        self.failure: str | None = None
        self._name, self._sight, self._set_out = name, sight, set_out
        self._goal = set_out()
        self._since, self._target = now, self._where()

    def cancel(self) -> None:
        """Withdraw the goal. Does nothing if it has ended."""
        self.end(f"the navigation to {said(self._name)} was cancelled")

    def end(self, failure: str | None) -> None:
        """End, as arrived or with the reason why not. Does nothing if it has ended."""
        if not self.done:
            self.done, self.failure = True, failure
            self._goal.end(failure)

    def step(self, now: float) -> None:
        """Go on at a second of the run."""
        if self.done:
            return
        if self._goal.done:
            self.end(self._sight.lost(self._name) if self._goal.failure is None else self._goal.failure)
        elif now - self._since >= _AGAIN and dist(self._where(), self._target) > _WALKED:
            try:
                self._goal = self._set_out()
            except RobotError as error:
                self.end(str(error))
            self._since, self._target = now, self._where()

    def _where(self) -> Point:
        return self._sight.where(self._name) or self._target

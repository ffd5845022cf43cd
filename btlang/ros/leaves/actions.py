"""An action of ROS 2 as a leaf: sends a goal, is RUNNING until its result, and cancels it when it is halted."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from math import inf
from uuid import uuid4

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from unique_identifier_msgs.msg import UUID

from btlang.engine.leaves.leaf import ActionFailed, Failed, described
from btlang.ros.awake import AWAKE
from btlang.ros.clients import Clients
from btlang.ros.filling import filler
from btlang.ros.goal_handle import unanswered
from btlang.ros.leaves.server import ANSWER, WAIT, Judge, Presence, awaited, nothing
from btlang.ros.word import Word

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_REFUSED = (CancelGoal.Response.ERROR_REJECTED, CancelGoal.Response.ERROR_NONE)  # rclpy says the latter


class Goal:
    """One goal. Methods with an underscore are for the thread that spins, the others for the one that ticks.

    `answer` is the response with the result, or the reason why there is none; None as long as it goes on.
    """

    def __init__(self, clients: Clients, client: Any, name: str, message: Any, wake: Callable[[], object]) -> None:
        self.answer: Any = None
        self.accepted = False
        self.heard = 0.0
        """When it last had word of the server, in seconds of AWAKE; 0 for never."""
        self._clients = clients
        self._client = client
        self._name = name
        self._message = message
        self._wake = wake
        self._goal_id = clients.lease.goal_id() if clients.lease is not None else UUID(uuid=list(uuid4().bytes))
        self._handle: Any = None
        self._cancelled = False
        self._waits_for = ""
        self._not_ended = f"{name} hasn't ended the cancelled goal"

    def send(self) -> None:
        """Asks the server to begin."""
        self._clients.post(self._send)

    def cancel(self) -> None:
        """Asks the server to end, and again when it accepts the goal after that; nothing where it has ended."""
        if self.answer is None and not self._cancelled:
            self._cancelled = True
            self._waits_for = f"{self._name} hasn't answered the halted goal"
            self._clients.endings.append(self)
            self._clients.post(self._cancel)

    def waits_for(self) -> str:
        """What a halted goal waits for; "" when it has ended."""
        return self._waits_for if self.answer is None else ""

    def _send(self) -> None:
        if self._cancelled:
            self._end("it was halted before it was sent")
            return
        try:
            sent = self._client.send_goal_async(self._message, self._hear, goal_uuid=self._goal_id)
            sent.add_done_callback(self._answered)
        except Exception as problem:
            self._end(f"the goal could not be sent to {self._name}: {described(problem)}")

    def _hear(self, _: object = None) -> None:
        self.heard = AWAKE.now()

    def _answered(self, future: Any) -> None:
        handle = future.result()
        if handle is None or not handle.accepted:
            self._end(f"{self._name} rejected the goal")
            return
        self._hear()
        if self._handle is None:
            self._follow(handle)
        if self._cancelled:
            self._cancel()

    def _follow(self, handle: Any) -> None:
        self._handle, self.accepted = handle, True
        handle.get_result_async().add_done_callback(lambda ended: self._end(ended.result()))

    def _cancel(self) -> None:
        if self.answer is None:
            if self._handle is not None:
                self._waits_for = self._not_ended
            handle = self._handle or unanswered(self._client, self._goal_id)
            handle.cancel_goal_async().add_done_callback(self._cancel_answered)

    def _cancel_answered(self, future: Any) -> None:
        response = future.result()
        if self._handle is None:
            if response.return_code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID:
                return
            self._waits_for = self._not_ended
            self._follow(unanswered(self._client, self._goal_id))
        if response.return_code in _REFUSED and not response.goals_canceling:
            self._waits_for = f"{self._name} refused to cancel its goal"

    def _end(self, answer: Any) -> None:
        self.answer = answer if answer is not None else "the answer got lost"
        self._wake()


def action_leaf(word: Word, clients: Clients) -> Callable[..., Any]:
    """A generator leaf that fills the goal as the table says. See goal_leaf."""
    cls = word.interface()
    return goal_leaf(word, clients, cls, filler(word, cls.Goal, word.ros.get("goal"), clients.clock.message))


def goal_leaf(
    word: Word, clients: Clients, cls: Any, make: Callable[[Mapping[str, Any]], Any], silence: float = inf
) -> Callable[..., Any]:
    """A generator leaf; `make` gives the goal for the values of the slots.

    FAILURE with a reason where there is no server, or where it rejects, aborts, is lost or does not answer, or gives no
    word of an accepted goal for as long as `silence`.
    """
    name = word.ros.name
    judge = Judge(word, cls.Result)
    client, limit = clients.action(cls, name), word.ros.get("wait", WAIT)
    status = clients.node.resolve_topic_name(f"{name}/_action/status")

    def servers() -> set[bytes]:
        return {bytes(end.endpoint_gid) for end in clients.node.get_publishers_info_by_topic(status)}

    def act(wake: Callable[[], object] = nothing, **values: Any) -> Generator[None, None, bool | Failed]:
        goal = Goal(clients, client, name, make(values), wake)
        yield from awaited(clients, client, cls, name, limit)
        presence = Presence(servers)
        try:
            goal.send()
            goal.heard = AWAKE.now()
            while goal.answer is None:
                quiet = AWAKE.now() - goal.heard
                if quiet > (silence if goal.accepted else ANSWER):
                    raise ActionFailed(
                        f"{name} {'sends no feedback on' if goal.accepted else 'does not answer'} the goal"
                    )
                yield
                if goal.answer is None and presence.is_lost():
                    goal.answer = f"the server of {name} is gone"
        finally:
            goal.cancel()
        return outcome(goal.answer)

    def outcome(answer: Any) -> bool | Failed:
        if isinstance(answer, str):
            return Failed(answer)
        said = judge.said(answer.result)
        if answer.status == GoalStatus.STATUS_SUCCEEDED:
            return judge.verdict(answer.result)
        if answer.status == GoalStatus.STATUS_CANCELED:
            return Failed(said or f"somebody else cancelled the goal of {name}")
        return Failed(said or f"{name} gave up")

    return act

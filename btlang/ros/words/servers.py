"""Leaves that call a server: actions, services, and phrases that `btc serve-actions` serves."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Mapping
from math import inf
from uuid import uuid4

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from unique_identifier_msgs.msg import UUID

from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere, describe_exception
from btlang.engine.script.values import as_text
from btlang.ros.clocks import AWAKE
from btlang.ros.goals import goal_handle
from btlang.ros.graph import is_ready, no_server
from btlang.ros.serving.names import RUN_PHRASE, SILENCE
from btlang.ros.words.clients import RosClients
from btlang.ros.words.fields import field_types, make_filler
from btlang.ros.words.word import RosWord
from btlang.vocabulary.value_type import format_number

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


WAIT = 5.0
"""Real seconds that a server has to appear, unless a table gives another time."""
ANSWER = 5.0
"""Seconds that the server of an action gets to accept a goal or to reject it."""
_REASONS = ("message", "error_msg", "error_string", "reason", "status_message")
_PAUSE = 0.5  # real seconds between two looks at a server
LIMIT = 10.0
"""Real seconds that an answer may take, unless a table gives another time."""
_GONE = 1.0  # seconds without a server, after which it counts as lost
_REFUSED = (CancelGoal.Response.ERROR_REJECTED, CancelGoal.Response.ERROR_NONE)  # rclpy says the latter


def await_server(clients: RosClients, client: Any, cls: Any, name: str, limit: float) -> Generator[None]:
    """Yield until there is a server. Raises ActionFailed when the limit is over."""
    until = time.monotonic() + limit
    while not is_ready(client):
        if time.monotonic() >= until:
            raise ActionFailed(NotThere(no_server(clients.node, cls, name)))
        yield


class Judge:
    """A judge of answers: whether one is a success, by the fields that the table names.

    If it names none, they are `success`, `error_code` and `message` or `error_msg`, as far as these exist. Raises
    MissionError (BT105).
    """

    def __init__(self, word: RosWord, cls: Any) -> None:
        types = field_types(cls)

        def named(key: str, usual: tuple[str, ...]) -> str:
            given: str | None = word.ros.get(key)
            if given is None:
                return next((name for name in usual if name in types), "")
            if given and given not in types:
                raise word.no_field(cls, given, given, types)
            return given

        self._failed, self._succeeded = named("failed", ("error_code",)), named("succeeded", ("success",))
        self._reason = named("reason", _REASONS)

    def said(self, answer: Any) -> str:
        """Return the reason in an answer, "" if it gives none."""
        return str(getattr(answer, self._reason)).strip() if self._reason else ""

    def verdict(self, answer: Any) -> bool | Failed:
        """Return True, or FAILURE with the reason."""
        if self._failed and getattr(answer, self._failed):
            return Failed(self.said(answer) or f"{self._failed} is {getattr(answer, self._failed)}")
        if self._succeeded and not getattr(answer, self._succeeded):
            return Failed(self.said(answer) or "it was refused")
        return True


class ServerPresence:
    """A check whether the server that got a request still exists: another one with its name
    doesn't know the request.
    """

    def __init__(self, there: Callable[[], set[bytes]]) -> None:
        self._there = there
        self._first = there()
        self._next = time.monotonic() + _PAUSE

    def is_lost(self) -> bool:
        """Return whether the server is gone, checked twice a second."""
        if time.monotonic() < self._next:
            return False
        self._next = time.monotonic() + _PAUSE
        now = self._there()
        self._first = self._first or now  # where it was not seen yet
        return bool(self._first) and not self._first & now


def do_nothing() -> None:
    """Do nothing, in place of the `wake` of a run."""


def service_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a generator leaf. A call can't be taken back: when it is halted, the answer is ignored."""
    cls, name = word.interface(), word.ros.name
    make = make_filler(word, cls.Request, word.ros.get("request"), clients.clock.message)
    judge = Judge(word, cls.Response)
    client = clients.service(cls, name)
    wait, limit = word.ros.get("wait", WAIT), word.ros.get("limit", LIMIT)

    def call(wake: Callable[[], object] = do_nothing, **values: Any) -> Generator[None, None, bool | Failed]:
        request = make(values)
        yield from await_server(clients, client, cls, name, wait)
        return judge.verdict((yield from await_answer(clients, client, name, request, limit, wake)))

    return call


def await_answer(
    clients: RosClients, client: Any, name: str, request: Any, limit: float, wake: Callable[[], object]
) -> Generator[None, None, Any]:
    """Yield until a service has answered; return the response. Raises ActionFailed if none comes."""
    answers: list[Any] = []

    def got(future: Any) -> None:
        answers.append(future.result())
        wake()

    def send() -> None:
        try:
            client.call_async(request).add_done_callback(got)
        except Exception as problem:
            answers.append(f"{name} could not be called: {describe_exception(problem)}")
            wake()

    clients.post(send)
    now = time.monotonic()
    until, seen = now + limit, now
    while not answers:
        yield
        now = time.monotonic()
        seen = now if is_ready(client) else seen
        if not answers and now - seen > _GONE:
            raise ActionFailed(NotThere(f"the server of {name} is gone"))
        if not answers and now >= until:
            raise ActionFailed(NotThere(f"{name} has not answered within {limit:g} s"))
    if isinstance(answers[0], str):
        raise ActionFailed(answers[0])
    return answers[0]


class ActionGoal:
    """One goal. Methods with an underscore are for the thread that spins, the others for the one that ticks.

    `answer` is the response with the result, or the reason why there is none; None as long as the goal goes on.
    """

    def __init__(self, clients: RosClients, client: Any, name: str, message: Any, wake: Callable[[], object]) -> None:
        self.answer: Any = None
        self.accepted = False
        self.heard = 0.0
        """When the server last answered, in seconds of AWAKE; 0 for never."""
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
        """Send the goal to the server."""
        self._clients.post(self._send)

    def cancel(self) -> None:
        """Ask the server to cancel, and again if it accepts the goal later; nothing if the goal has ended."""
        if self.answer is None and not self._cancelled:
            self._cancelled = True
            self._waits_for = f"{self._name} hasn't answered the halted goal"
            self._clients.endings.append(self)
            self._clients.post(self._cancel)

    def waits_for(self) -> str:
        """Return what a halted goal waits for; "" when it has ended."""
        return self._waits_for if self.answer is None else ""

    def _send(self) -> None:
        if self._cancelled:
            self._end("it was halted before it was sent")
            return
        try:
            sent = self._client.send_goal_async(self._message, self._hear, goal_uuid=self._goal_id)
            sent.add_done_callback(self._on_answer)
        except Exception as problem:
            self._end(f"the goal could not be sent to {self._name}: {describe_exception(problem)}")

    def _hear(self, _: object = None) -> None:
        self.heard = AWAKE.now()

    def _on_answer(self, future: Any) -> None:
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
            handle = self._handle or goal_handle(self._client, self._goal_id)
            handle.cancel_goal_async().add_done_callback(self._cancel_answered)

    def _cancel_answered(self, future: Any) -> None:
        response = future.result()
        if self._handle is None:
            if response.return_code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID:
                return
            self._waits_for = self._not_ended
            self._follow(goal_handle(self._client, self._goal_id))
        if response.return_code in _REFUSED and not response.goals_canceling:
            self._waits_for = f"{self._name} refused to cancel its goal"

    def _end(self, answer: Any) -> None:
        self.answer = answer if answer is not None else "the answer got lost"
        self._wake()


def action_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a generator leaf that fills the goal as the table says. See goal_leaf."""
    cls = word.interface()
    return goal_leaf(word, clients, cls, make_filler(word, cls.Goal, word.ros.get("goal"), clients.clock.message))


def goal_leaf(
    word: RosWord, clients: RosClients, cls: Any, make: Callable[[Mapping[str, Any]], Any], silence: float = inf
) -> Callable[..., Any]:
    """Return a generator leaf; `make` returns the goal for the values of the slots.

    FAILURE with a reason if there is no server, or if it rejects, aborts, is lost or doesn't answer, or sends no
    feedback on an accepted goal for as long as `silence`.
    """
    name = word.ros.name
    judge = Judge(word, cls.Result)
    client, limit = clients.action(cls, name), word.ros.get("wait", WAIT)
    status = clients.node.resolve_topic_name(f"{name}/_action/status")

    def servers() -> set[bytes]:
        return {bytes(end.endpoint_gid) for end in clients.node.get_publishers_info_by_topic(status)}

    def act(wake: Callable[[], object] = do_nothing, **values: Any) -> Generator[None, None, bool | Failed]:
        goal = ActionGoal(clients, client, name, make(values), wake)
        yield from await_server(clients, client, cls, name, limit)
        presence = ServerPresence(servers)
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


def phrase_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a generator leaf. Values are sent in the units whose factor is 1; the server has defaults for missing
    ones.
    """
    cls = word.interface(RUN_PHRASE)

    def make(values: Mapping[str, Any]) -> Any:
        return cls.Goal(phrase=word.ros.interface, names=list(values), values=[_text(v) for v in values.values()])

    return goal_leaf(word, clients, cls, make, SILENCE)


def _text(value: Any) -> str:
    return format_number(value) if isinstance(value, float) else as_text(value)

"""Calls of services and goals of actions for clients, and waits for what the ROS graph doesn't report."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from btlang.ros.bridge.conversion import as_data, fill_message, type_of
from btlang.ros.bridge.replies import BridgeError, answer, reason_of
from btlang.ros.bridge.topics import full
from btlang.ros.graph import absent, is_ready, types_of
from btlang.ros.lease import Lease
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Asked: TypeAlias = dict[str, Any]
    Reply: TypeAlias = Callable[[dict[str, Any]], object]
    Fail: TypeAlias = Callable[[str], object]

_LOOK = 0.02  # seconds between two looks
_FOUND = 5.0  # seconds in which a server is found
_ANSWERED, _LONGEST = 10.0, 600.0  # seconds for an answer: by default, and at most
_SETTLE = 0.3  # seconds: a server that hasn't found its new client yet drops the answer, and nothing reports when


class _Wait(Record):
    ready: Callable[[], object]
    then: Callable[[], object]
    late: Callable[[str], object]
    reason: Callable[[], str]
    until: float


class Waits:
    """The waits of one node, which another thread spins."""

    def __init__(self, node: Node) -> None:
        self._waits: list[_Wait] = []
        self._timer = node.create_timer(_LOOK, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._timer.cancel()

    def when(
        self,
        ready: Callable[[], object],
        then: Callable[[], object],
        late: Callable[[str], object],
        reason: Callable[[], str],
        seconds: float,
    ) -> None:
        """Call `then` once `ready` holds, or `late` with a reason: the given one, or the error of one of the two."""
        self._waits.append(_Wait(ready, then, late, reason, time.monotonic() + seconds))
        self._timer.reset()

    def _look(self) -> None:
        waits, self._waits = self._waits, []
        self._waits += [wait for wait in waits if not self._is_over(wait)]
        if not self._waits:
            self._timer.cancel()

    def _is_over(self, wait: _Wait) -> bool:
        try:
            if wait.ready():
                wait.then()
                return True
        except Exception as error:  # also of ROS: the others go on
            wait.late(reason_of(error))
            return True
        if time.monotonic() < wait.until:
            return False
        wait.late(wait.reason())
        return True


class Servers:
    """Clients of servers on a node, one for each name and type, for the thread that spins the node."""

    def __init__(self, node: Node) -> None:
        self.node, self.waits = node, Waits(node)
        self.lease = Lease(node)  # before the clients of actions
        self.now = lambda: node.get_clock().now().to_msg()
        self._clients: dict[tuple[str, Any], tuple[Any, float]] = {}

    def find(self, kind: str, name: str, cls: Any, then: Callable[[Any, Any], object], fail: Fail) -> None:
        """Call `then` with the class and a client that can be used now, or `fail`.

        `kind` is "service" or "action". If the class is None, it is the one in the graph.
        """
        found = cls
        name = full(name)

        def client() -> Any:
            made, since = self._clients[name, found]
            return made if time.monotonic() - since > _SETTLE and is_ready(made) else None

        def ready() -> object:
            nonlocal found
            types = types_of(self.node, kind, name) if found is None else ()
            if types:
                found = type_of(min(types), "srv")
            if found is None:
                return False
            if (name, found) not in self._clients:
                made = (
                    ActionClient(self.node, found, name) if kind == "action" else self.node.create_client(found, name)
                )
                self._clients[name, found] = made, time.monotonic()
            return client() is not None

        def reason() -> str:
            why = f"there is no {kind} server {name}" if found is None else absent(self.node, kind, name, found)
            why = why or f"the {kind} server {name} is not connected yet"
            return f"{why[0].upper()}{why[1:]}."

        self.waits.when(ready, lambda: then(found, client()), fail, reason, _FOUND)


class BridgeCall:
    """A service that a client calls. Raises BridgeError."""

    def __init__(self, servers: Servers, asked: Asked, reply: Reply, fail: Fail) -> None:
        self.ended = False
        seconds = asked.get("timeout")
        if seconds is not None and (not isinstance(seconds, int | float) or isinstance(seconds, bool)):
            raise BridgeError("'timeout' must be a number.")
        self._seconds = _ANSWERED if seconds is None else min(seconds, _LONGEST) if seconds > 0 else _LONGEST
        self._servers, self._asked, self._reply, self._fail = servers, asked, reply, fail
        servers.find("service", asked["service"], None, self._send, self._late)

    def end(self) -> None:
        """Stop waiting for the answer."""
        self.ended = True

    def _send(self, cls: Any, client: Any) -> None:
        if self.ended:
            return
        future = client.call_async(fill_message(cls.Request, self._asked.get("args") or {}, self._servers.now))
        future.add_done_callback(self._on_answer)

        def late(reason: str) -> None:
            client.remove_pending_request(future)
            self._late(reason)

        reason = f"{self._asked['service']} hasn't answered within {self._seconds:g} s."
        self._servers.waits.when(future.done, int, late, lambda: reason, self._seconds)

    def _on_answer(self, future: Any) -> None:
        if not self.ended:
            self.ended = True
            self._reply(answer(self._asked, as_data(future.result()), success=True))

    def _late(self, reason: str) -> None:
        if not self.ended:
            self.ended = True
            self._fail(reason)


class BridgeGoal:
    """A goal that a client sends; `feedback` is called with each message on the way. Raises BridgeError."""

    def __init__(self, servers: Servers, asked: Asked, reply: Reply, fail: Fail, feedback: Reply) -> None:
        self.ended = False
        self._servers, self._asked, self._reply, self._fail, self._feedback = servers, asked, reply, fail, feedback
        self._is_sent = self._is_cancelled = False
        self._client: Any = None
        self._handle: Any = None
        cls = type_of(str(asked.get("action_type", "")), "action")
        self._goal = fill_message(cls.Goal, asked.get("args") or {}, servers.now)
        servers.find("action", asked["action"], cls, self._send, self._end_badly)

    def cancel(self) -> None:
        """Cancel the goal. One that isn't sent yet never is."""
        if self._is_cancelled:
            return
        self._is_cancelled = True
        if self._handle is not None:
            self._handle.cancel_goal_async()
        elif not self._is_sent:
            self._end_badly("The goal was cancelled before it was sent.")

    def _send(self, cls: Any, client: Any) -> None:
        if self.ended:
            return
        self._is_sent, self._client = True, client
        future = client.send_goal_async(self._goal, self._hear, self._servers.lease.goal_id())
        future.add_done_callback(self._on_accept)
        self._watch()

    def _watch(self) -> None:
        """End the goal if its server has died: a dead server reports nothing."""
        gone = partial(self._end_badly, f"The action server {self._asked['action']} has gone.")
        self._servers.waits.when(lambda: self.ended or not is_ready(self._client), gone, self._end_badly, str, math.inf)

    def _on_accept(self, future: Any) -> None:
        self._handle = future.result()
        if not self._handle.accepted:
            self._end_badly("The goal was rejected.")
            return
        if self._is_cancelled:
            self._handle.cancel_goal_async()
        self._handle.get_result_async().add_done_callback(self._done)

    def _hear(self, message: Any) -> None:
        if self._asked.get("feedback") is True and not self.ended:
            about = {} if self._asked.get("id") is None else {"id": self._asked["id"]}
            values = as_data(message.feedback)
            self._feedback({"op": "action_feedback", **about, "action": self._asked["action"], "values": values})

    def _done(self, future: Any) -> None:
        if not self.ended:
            self.ended = True
            result = future.result()
            success = result.status == GoalStatus.STATUS_SUCCEEDED
            self._reply(answer(self._asked, as_data(result.result), success=success, goal=result.status))

    def _end_badly(self, reason: str) -> None:
        if not self.ended:
            self.ended = True
            self._fail(reason)

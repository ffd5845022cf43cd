"""Short services of a robot: the thread that spins calls them, the tick looks at what was answered."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from threading import Event, Lock
from typing import Any

from rclpy.node import Node

from btlang.engine.leaves.leaf import NotThere
from btlang.robots.robot import RobotError
from btlang.ros.clocks import AWAKE
from btlang.ros.node import ExecutorThread

_ANSWER = 3.0  # seconds of real time


class ServiceCall:
    """A service call as an Operation. `end` may be called from any thread.

    A call can't be taken back: if it is cancelled, the answer is ignored.
    """

    def __init__(self, name: str, accomplished: Callable[[str], object]) -> None:
        self.done = False
        self.failure: str | None = None
        self._name, self._accomplished = name, accomplished
        self._since = AWAKE.now()
        self._lock = Lock()
        self._answer: Any = None

    def cancel(self) -> None:
        """Ignore the answer."""
        self.end(f"the call of {self._name} was cancelled")

    def end(self, failure: str | None) -> None:
        """End the call, as accomplished or with the reason why not. Does nothing if it has ended."""
        with self._lock:
            if not self.done:
                self.failure, self.done = failure, True

    def on_answer(self, answer: Any) -> None:
        """Store the answer, in the thread that spins."""
        self._answer = answer

    def look(self) -> None:
        """Go on with what has come, in the thread that ticks."""
        answer = self._answer
        if self.done:
            return
        if answer is None:
            if AWAKE.now() - self._since > _ANSWER:
                self.end(f"no answer from {self._name} for {_ANSWER:g} s")
        elif not answer.success:
            self.end(answer.message or f"{self._name} refused")
        else:
            try:
                self._accomplished(str(answer.message))
                self.end(None)
            except RobotError as error:
                self.end(str(error))


class Services:
    """Clients of services by their names. `fire` and `stop` may be called from any thread."""

    def __init__(self, node: Node, executor: ExecutorThread) -> None:
        self._node, self._executor = node, executor
        self._clients: dict[str, Any] = {}
        self._types: dict[str, Any] = {}
        self._calls: list[ServiceCall] = []
        self._fired: list[Event] = []

    def add(self, name: str, kind: Any) -> None:
        """Make a client early, so that it has found its server when it is needed."""
        self._clients[name] = self._node.create_client(kind, name)
        self._types[name] = kind

    def call(self, name: str, accomplished: Callable[[str], object], **fields: Any) -> ServiceCall:
        """Call a service without waiting. Raises RobotError if nobody serves it.

        If the answer is yes, a `step` calls `accomplished` with its message; a RobotError from there is a failure.
        """
        shown = self._clients[name].service_name
        if not self._clients[name].service_is_ready():
            raise RobotError(NotThere(f"there is no service {shown}"))
        call = ServiceCall(shown, accomplished)
        self._send(name, fields, call.on_answer)
        self._calls.append(call)
        return call

    def fire(self, name: str, **fields: Any) -> None:
        """Call a service, if somebody serves it, and ignore the answer."""
        if self._clients[name].service_is_ready():
            answered = Event()
            self._fired.append(answered)
            self._send(name, fields, lambda answer: answered.set())

    def step(self) -> None:
        """Go on with the answers since the previous step."""
        for call in self._calls:
            call.look()
        self._calls = [call for call in self._calls if not call.done]

    def stop(self, reason: str) -> None:
        """Ignore the answers to all calls that are still open."""
        for call in tuple(self._calls):
            call.end(reason)

    def confirm(self, seconds: float) -> None:
        """Wait until every fired call is answered, at most so many seconds."""
        until = time.monotonic() + seconds
        for event in tuple(self._fired):
            if event.wait(max(0.0, until - time.monotonic())):
                self._fired.remove(event)

    def _send(self, name: str, fields: dict[str, Any], answered: Callable[[Any], object]) -> None:
        client, request = self._clients[name], self._types[name].Request(**fields)
        self._executor.post(partial(_ask, client, request, answered))


def _ask(client: Any, request: Any, answered: Callable[[Any], object]) -> None:
    client.call_async(request).add_done_callback(lambda future: answered(future.result()))

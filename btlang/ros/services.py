"""Short services of a robot: called in the tick, which waits for the answer, but never long."""

from __future__ import annotations

import time
from threading import Event
from typing import Any

from rclpy.node import Node

from btlang.robots.robot import RobotError

_ANSWER = 3.0  # seconds of real time


class Services:
    """Clients of services by their names. `fire` may be called from any thread."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._clients: dict[str, Any] = {}
        self._types: dict[str, Any] = {}

    def add(self, name: str, kind: Any) -> None:
        """Makes the client, so that it has found its server when it is needed."""
        self._clients[name] = self._node.create_client(kind, name)
        self._types[name] = kind

    def call(self, name: str, **fields: Any) -> str:
        """The message of the answer. Raises RobotError where the answer is no, or none, or nobody serves it."""
        client = self._clients[name]
        if not client.service_is_ready():
            raise RobotError(f"nothing serves {name}")
        answered = Event()
        future = client.call_async(self._types[name].Request(**fields))
        future.add_done_callback(lambda _: answered.set())
        if not answered.wait(_ANSWER):
            client.remove_pending_request(future)
            raise RobotError(f"no answer from {name} for {_ANSWER:g} s")
        answer = future.result()
        if not answer.success:
            raise RobotError(answer.message or f"{name} refused")
        return str(answer.message)

    def fire(self, name: str) -> Event:
        """Calls it, where somebody serves it, and does not wait; the event is set when it was answered."""
        answered = Event()
        client = self._clients[name]
        if client.service_is_ready():
            client.call_async(self._types[name].Request()).add_done_callback(lambda _: answered.set())
        else:
            answered.set()
        return answered


def wait_all(events: list[Event], seconds: float) -> None:
    """Until all are set, but so long at most."""
    until = time.monotonic() + seconds
    for event in events:
        event.wait(max(0.0, until - time.monotonic()))

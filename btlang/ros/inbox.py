"""The latest messages of a robot: callbacks put them in, the tick takes them out."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data

from btlang.robots.robot import RobotError

_KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_MOST = 1000  # messages of one topic that wait for a tick; older ones are forgotten
QOS = {"sensor": qos_profile_sensor_data, "events": QoSProfile(depth=100), "state": _KEPT}
"""How a topic is listened to: a sensor's messages may be lost, each event counts, a state is told to who comes late."""


class Inbox:
    """Ages are counted from arrival, by the system's clock, so that a robot whose own clock stands still is silent too.

    They are counted by `now` as well, the seconds of a simulator that may be faster than real time.
    """

    def __init__(self, node: Node, now: Callable[[], float] = time.monotonic) -> None:
        self._node = node
        self._now = now
        self._latest: dict[str, tuple[Any, float, float]] = {}
        self._events: dict[str, deque[Any]] = {}
        self._read: dict[str, Any] = {}
        self._called: dict[str, tuple[str, str]] = {}

    def listen(
        self, topic: str, kind: type, what: str, qos: str = "sensor", also: Callable[[Any], object] | None = None
    ) -> None:
        """Subscribes; `what` names the messages for people. `also` is called with each, in the thread that spins."""
        self._called[topic] = what, self._node.resolve_topic_name(topic)
        if qos != "sensor":
            self._events[topic] = deque(maxlen=_MOST)

        def arrived(message: Any) -> None:
            if also is not None:
                also(message)
            if qos != "sensor":
                self._events[topic].append(message)
            self._latest[topic] = message, time.monotonic(), self._now()

        self._node.create_subscription(kind, topic, arrived, QOS[qos])

    def read(self) -> None:
        """From now on `get` gives what has arrived until now, so that all leaves of a tick see the same."""
        self._read = {topic: message for topic, (message, *_) in self._latest.copy().items()}

    def events(self, topic: str) -> list[Any]:
        """The messages since the last call, oldest first."""
        waiting = self._events[topic]
        return [waiting.popleft() for _ in range(len(waiting))]

    def has(self, topic: str) -> bool:
        """Whether a message has ever come, also since the latest `read`."""
        return topic in self._latest

    def shown(self, topic: str) -> str:
        """The name of a topic that is listened to, with the namespace."""
        return self._called[topic][1]

    def get(self, topic: str, limit: float | None = None) -> Any:
        """The latest message. Raises RobotError where there is none, or none for `limit` seconds."""
        what, shown = self._called[topic]
        if topic not in self._read:
            raise RobotError(f"no {what}: nothing has come on {shown}")
        _, *arrived = self._latest[topic]  # after a tick that took long, newer ones are there but not read yet
        if limit is not None and max(time.monotonic() - arrived[0], self._now() - arrived[1]) > limit:
            raise RobotError(f"no {what} for {limit:g} s: {shown} is silent")
        return self._read[topic]

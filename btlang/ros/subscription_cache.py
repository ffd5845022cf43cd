"""The latest messages of a robot: callbacks put them in, the tick takes them out."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from btlang.robots.robot import SensorSilent
from btlang.ros.awake import AWAKE
from btlang.ros.gate import Gate
from btlang.ros.latest import Latest, LatestJoints, latest_of

_KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_MOST = 1000  # messages of one topic that wait for a tick; older ones are forgotten
_NONSENSE = 2.0  # seconds in which only what is refused has come, however slow the topic is
QOS = {"events": QoSProfile(depth=100), "state": _KEPT}
"""How a topic is listened to: each event counts, late listeners get a state too. Those of a sensor may be lost."""


class SubscriptionCache:
    """Ages are counted from arrival, in the seconds of `now`. What the gate refuses counts as silence."""

    def __init__(self, node: Node, now: Callable[[], float] = AWAKE.now) -> None:
        self._node = node
        self._now = now
        self._latest: dict[str, Latest] = {}
        self._events: dict[str, deque[Any]] = {}
        self._read: dict[str, Any] = {}
        self._what: dict[str, str] = {}

    def listen(
        self,
        topic: str,
        kind: type,
        what: str,
        qos: str = "sensor",
        also: Callable[[Any], object] | None = None,
        refuses: Callable[[Any], str] | None = None,
        key: str = "",
    ) -> None:
        """Subscribes; `what` names the messages for people. `also` is called with each, in the thread that spins.

        `refuses` is a gate in place of the one that messages of this kind have, `key` the name in place of the topic by
        which they are asked for.
        """
        key = key or topic
        self._what[key] = what
        named, refuses = self._node.resolve_topic_name(topic), refuses or self._gate(kind).refuses
        latest = latest_of(kind)(named, self._now, refuses=refuses)
        self._latest[key] = latest
        if qos != "sensor":
            self._events[key] = deque(maxlen=_MOST)

        def arrived(message: Any) -> None:
            if not latest.store(message):
                return
            if also is not None:
                also(message)
            if qos != "sensor":
                self._events[key].append(message)

        profile = QoSProfile(depth=latest.depth, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._node.create_subscription(kind, topic, arrived, QOS.get(qos, profile))

    def _gate(self, kind: type) -> Gate:
        return Gate(kind, lags=not self._node.get_clock().ros_time_is_active)

    def read(self) -> None:
        """From now on `get` gives what has arrived until now, so that all leaves of a tick see the same."""
        self._read = {topic: latest.message for topic, latest in self._latest.items() if latest.has_come}

    def events(self, topic: str) -> list[Any]:
        """The messages since the last call, oldest first."""
        waiting = self._events[topic]
        return [waiting.popleft() for _ in range(len(waiting))]

    def has(self, topic: str) -> bool:
        """Whether a message has ever come, also since the latest `read`."""
        return self._latest[topic].has_come

    def why_not(self, topic: str) -> str:
        """Why there is no message to believe, "" where the latest one is."""
        return self._latest[topic].refused or self._latest[topic].why_not()

    def is_published(self, topic: str) -> bool:
        """Whether somebody publishes a topic that is listened to."""
        return bool(self._node.count_publishers(self._latest[topic].named))

    def shown(self, topic: str) -> str:
        """The name of a topic that is listened to, with the namespace."""
        return self._latest[topic].named

    def get(self, topic: str, limit: float | None = None) -> Any:
        """The latest message. Raises SensorSilent if there is none, or none for `limit` seconds."""
        what, latest = self._what[topic], self._latest[topic]
        if topic not in self._read:
            raise SensorSilent(f"no {what}: {latest.refused or f'nothing has arrived on {latest.named}'}")
        # after a tick that took long, newer ones are there but not read yet
        if limit is not None:
            limit = min(limit, _NONSENSE) if latest.refused else limit
            if latest.silence() > limit:
                raise SensorSilent(f"no {what} for {limit:g} s: {latest.refused or f'{latest.named} is silent'}")
        return self._read[topic]

    def reading(self, topic: str, fresh: float) -> tuple[Any, float, str] | None:
        """The latest message, when it arrived, and why it isn't to be believed: nothing that can be true has come for
        `fresh` seconds. None if no message has ever come.
        """
        latest = self._latest[topic]
        if not latest.has_come:
            return None
        silence = latest.silence()
        reason = latest.refused or f"{latest.named} is silent for {silence:.1f} s"
        return latest.message, latest.arrived, reason if silence > fresh else ""

    def latest_joints(self, topic: str) -> LatestJoints:
        """The joints that a topic reports."""
        latest = self._latest[topic]
        assert isinstance(latest, LatestJoints)
        return latest

    def latest(self, topic: str, limit: float) -> Any:
        """As `get`, but None in place of an error."""
        try:
            return self.get(topic, limit)
        except SensorSilent:
            return None

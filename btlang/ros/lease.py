"""Leases: who sends goals shows that it lives, so that a server halts the goals of one that has died.

A client holds a publisher that never publishes, on a topic that its goal ids name. DDS itself asserts its liveliness,
in a thread that no Python holds up. A goal id that names no such topic is that of another program: it is not watched.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from itertools import count

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty
from unique_identifier_msgs.msg import UUID

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MARK = b"btc\x01"
_CLIENT, _GOAL = 6, 6  # bytes of a goal id, after the mark
_ASSERTED = 0.25  # seconds within which a client asserts that it lives: a few of them may get lost
_SILENCE, _DOUBT = 0.7, 0.3  # seconds without a word, and those in which one may still come
_FIRST = 1.5  # seconds for the first word


class Lease:
    """Of a client, for as long as its node lives. Make it before the clients of actions, whose servers then know it."""

    def __init__(self, node: Node) -> None:
        self._client = os.urandom(_CLIENT)
        self._numbers = count(1)
        self._publisher = node.create_publisher(Empty, _topic(self._client), _qos(_ASSERTED))

    def goal_id(self) -> UUID:
        """The `goal_uuid` for send_goal_async of a goal that is to be halted when this process dies."""
        return UUID(uuid=list(_MARK + self._client + next(self._numbers).to_bytes(_GOAL, "big")))


class Leases:
    """What a server knows of its clients. To be used in the thread that spins the node."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._watched: dict[bytes, _Client] = {}

    def watch(self, goal_id: bytes, lost: Callable[[], object]) -> None:
        """Calls `lost` once when the client of a goal has been silent for a second, unless the goal is forgotten."""
        if not goal_id.startswith(_MARK):
            return
        name = goal_id[len(_MARK) : len(_MARK) + _CLIENT]
        if name not in self._watched:
            self._watched[name] = _Client(self._node, name, self._clock)
        self._watched[name].goals[goal_id] = lost

    def forget(self, goal_id: bytes) -> None:
        """The goal is over."""
        name = goal_id[len(_MARK) : len(_MARK) + _CLIENT]
        client = self._watched.get(name) if goal_id.startswith(_MARK) else None
        if client is not None:
            client.goals.pop(goal_id, None)
            if not client.goals:
                del self._watched[name]
                client.close()


class _Client:
    """One that has goals; `goals` has what to call when it is lost."""

    def __init__(self, node: Node, name: bytes, clock: Clock) -> None:
        self.goals: dict[bytes, Callable[[], object]] = {}
        self._node, self._clock, self._topic = node, clock, _topic(name)
        self._timer: Any = node.create_timer(_FIRST, self._never_heard, clock=clock)
        self._subscription = node.create_subscription(
            Empty, self._topic, lambda _: None, _qos(_SILENCE),
            event_callbacks=SubscriptionEventCallbacks(liveliness=self._changed),
        )  # fmt: skip

    def close(self) -> None:
        """Nobody asks any more."""
        self._trust()
        self._node.destroy_subscription(self._subscription)

    def _changed(self, info: Any) -> None:
        """Silence may be that of this process, which was held up: what has come meanwhile is then heard in a moment."""
        if info.alive_count:
            self._trust()
        elif self._timer is None:
            self._timer = self._node.create_timer(_DOUBT, self._lost, clock=self._clock)

    def _never_heard(self) -> None:
        """It died as soon as it had sent its goal; where it never had a lease, something else passed the goal on."""
        if self._node.count_publishers(self._topic):
            self._lost()
        else:
            self._trust()

    def _trust(self) -> None:
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None

    def _lost(self) -> None:
        self._trust()
        for lost in tuple(self.goals.values()):
            lost()


def _topic(client: bytes) -> str:
    return f"/_btlang/lease_{client.hex()}"


def _qos(seconds: float) -> QoSProfile:
    return QoSProfile(
        depth=1, liveliness=LivelinessPolicy.AUTOMATIC, liveliness_lease_duration=Duration(seconds=seconds)
    )

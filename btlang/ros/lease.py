"""Leases of clients: a client shows that it is alive, so that a server halts the goals of one that has died.

A client holds a publisher that never publishes, on a topic that its goal ids name. DDS itself asserts its liveliness,
in a thread that no Python holds up. A goal id that names no such topic is that of another program: it is not watched.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from itertools import count

from rcl_interfaces.srv import GetParameters
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
_SILENCE = 0.7  # seconds without a word after which DDS reports it
_ROUND = 0.1  # seconds
_SILENT, _FIRST = 3, 15  # rounds in which a word may still come, and those in which the first one should
_ASKED = 11  # rounds before the end of these in which it is asked for an answer: most are heard before


class Lease:
    """A lease of a client, for as long as its node lives. Make it before clients of actions,
    so that servers know it.
    """

    def __init__(self, node: Node) -> None:
        self._client = os.urandom(_CLIENT)
        self._numbers = count(1)
        self._publisher = node.create_publisher(Empty, _topic(self._client), _qos(_ASSERTED))

    def goal_id(self) -> UUID:
        """Return the `goal_uuid` for send_goal_async of a goal that is to be halted if this process dies."""
        return UUID(uuid=list(_MARK + self._client + next(self._numbers).to_bytes(_GOAL, "big")))


class Leases:
    """The leases of the clients of a node's servers, for the thread that spins the node."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._clients: dict[bytes, _LeaseHolder] = {}

    def watch(self, goal_id: bytes, lost: Callable[[], object]) -> None:
        """Call `lost` once if the client of a goal has been silent for a second, unless the goal is forgotten."""
        name = _client_of(goal_id)
        if name is None:
            return
        if name not in self._clients:
            self._clients[name] = _LeaseHolder(self._node, name, self._clock, lambda: self._clients.pop(name))
        self._clients[name].goals[goal_id] = lost

    def forget(self, goal_id: bytes) -> None:
        """Forget a goal that is over."""
        name = _client_of(goal_id)
        if name in self._clients:
            self._clients[name].goals.pop(goal_id, None)


class _LeaseHolder:
    """A client that has sent goals, watched until it is gone.

    It is never subscribed twice: in Fast DDS a second subscription would hear nothing of it. `goals` has the functions
    to call when it is lost; `gone` is called then.
    """

    def __init__(self, node: Node, name: bytes, clock: Clock, gone: Callable[[], object]) -> None:
        self.goals: dict[bytes, Callable[[], object]] = {}
        self._node, self._topic, self._gone = node, _topic(name), gone
        self._heard = self._asked = self._answered = False
        self._question: Any = None
        self._rounds = _FIRST
        self._timer = node.create_timer(_ROUND, self._count_round, clock=clock)
        self._subscription = node.create_subscription(
            Empty, self._topic, lambda _: None, _qos(_SILENCE),
            event_callbacks=SubscriptionEventCallbacks(liveliness=self._on_liveliness),
        )  # fmt: skip

    def _on_liveliness(self, info: Any) -> None:
        """Doubt a silent client: the silence may be that of this process, which then hears in a
        moment what has come.
        """
        if info.alive_count:
            self._heard = True
            self._timer.cancel()
        elif self._heard:
            self._rounds = _SILENT
            self._timer.reset()

    def _count_round(self) -> None:
        """Count rounds rather than seconds: in each round this process was able to hear something."""
        self._rounds -= 1
        if not self._heard and self._rounds < _ASKED:
            self._ask()
        found = self._node.get_publishers_info_by_topic(self._topic) if self._rounds <= 0 else []
        if self._rounds > 0 or (found and self._answered and not self._heard):
            return  # DDS doesn't report the life of one that answers: then discovery reports its end
        # where it was never heard: it died as soon as it had sent its goal, or has no lease and something passed it on
        lost = tuple(self.goals.values()) if self._heard or self._answered or found else ()
        if self._question is not None:
            self._node.destroy_client(self._question)
        self._node.destroy_timer(self._timer)
        self._node.destroy_subscription(self._subscription)
        self._gone()
        for notify in lost:
            notify()

    def _ask(self) -> None:
        """Ask the node of the client, which answers if it is spun, when liveliness hasn't come
        although it should have.
        """
        if self._question is None:
            for end in self._node.get_publishers_info_by_topic(self._topic):
                name = f"{end.node_namespace.rstrip('/')}/{end.node_name}/get_parameters"
                self._question = self._node.create_client(GetParameters, name)
        elif not self._asked and self._question.service_is_ready():
            self._asked = True
            self._question.call_async(GetParameters.Request()).add_done_callback(self._live)

    def _live(self, _: object) -> None:
        self._answered = True


def _client_of(goal_id: bytes) -> bytes | None:
    """Return the client of a goal; None for a goal without a lease."""
    return goal_id[len(_MARK) : len(_MARK) + _CLIENT] if goal_id.startswith(_MARK) else None


def _topic(client: bytes) -> str:
    return f"/_btlang/lease_{client.hex()}"


def _qos(seconds: float) -> QoSProfile:
    return QoSProfile(
        depth=1, liveliness=LivelinessPolicy.AUTOMATIC, liveliness_lease_duration=Duration(seconds=seconds)
    )

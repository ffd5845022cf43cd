"""What one client hears of topics, and what it publishes."""

from __future__ import annotations

import json
import time
from collections.abc import Callable

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from btlang.ros.bridge.conversion import as_data, fill_message, type_of
from btlang.ros.bridge.replies import MOST_CHARACTERS, BridgeError
from btlang.ros.graph import types_of
from btlang.ros.messages import type_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Deliver: TypeAlias = Callable[[str, str, int], object]

_DISCOVERED = 5.0  # seconds in which the publishers of a topic are found
_MOST_BYTES = 4 * MOST_CHARACTERS  # of a message as ROS sends it: JSON may have fewer characters than that
_DEPTH, _MOST_DEPTH = 10, 100  # messages that wait for a client: by default, and at most
_LONGEST = 3_600_000  # milliseconds
_HEARD = Duration(seconds=0.2)  # for listeners to confirm what was published


class Subscription:
    """One topic of one client. Call `look` now and then: it finds the type and adapts to the publishers.

    `deliver` gets the topic as the client calls it, a message, and how many may wait; `refuse` gets the reason why
    there is none.
    """

    def __init__(self, node: Node, topic: str, deliver: Deliver, refuse: Callable[[str], object]) -> None:
        self._node, self._topic, self._deliver, self._refuse = node, topic, deliver, refuse
        self._name = full(topic)
        self._cls: Any = None
        self._wanted: dict[object, tuple[float, int]] = {}
        self._period, self._depth = 0.0, _DEPTH
        self._since = time.monotonic()
        self._subscription: Any = None
        self._qos: QoSProfile | None = None
        self._timer: Any = None  # runs while the next message has to wait
        self._newest: bytes | None = None
        self._has_refused = False

    def add_request(self, asked: dict[str, Any]) -> None:
        """Add a subscription of the client to the topic, or change one. Raises BridgeError."""
        rate, length = asked.get("throttle_rate") or 0, asked.get("queue_length") or 0
        for value, most, name in ((rate, _LONGEST, "throttle_rate"), (length, 1e9, "queue_length")):
            if not isinstance(value, int | float) or isinstance(value, bool) or not 0 <= value <= most:
                raise BridgeError(f"'{name}' must be a number from 0 to {most:,.0f}.")
        if asked.get("compression") not in (None, "none"):
            raise BridgeError("This server has no compression but 'none'.")
        if asked.get("type") not in (None, ""):
            cls = type_of(str(asked["type"]), "msg")
            if self._cls not in (None, cls):
                raise BridgeError(f"You have subscribed to {self._topic} as {type_name(self._cls)} already.")
            self._cls = cls
        self._wanted[asked.get("id")] = rate / 1000, min(int(length), _MOST_DEPTH) or _DEPTH
        self._fit()

    def remove_request(self, id: object) -> bool:
        """End one subscription, or all for None; return whether it was the last one. Raises BridgeError."""
        if id is not None and id not in self._wanted:
            raise BridgeError(f"There's no subscription to {self._topic} with this id.")
        if id is None:
            self._wanted.clear()
        self._wanted.pop(id, None)
        if self._wanted:
            self._fit()
        return not self._wanted

    def look(self) -> None:
        """Subscribe with a quality of service that fits all publishers, if there are any yet. Raises BridgeError."""
        publishers = self._node.get_publishers_info_by_topic(self._name)
        types = {each.topic_type for each in publishers}
        if self._cls is None and types:
            self._cls = type_of(min(types), "msg")
        if self._cls is None:
            if time.monotonic() - self._since > _DISCOVERED:
                raise BridgeError(f"Nobody publishes {self._name}, so its type isn't known.")
            return
        if types and type_name(self._cls) not in types:
            raise BridgeError(f"{self._name} is of the type {min(types)}, not {type_name(self._cls)}.")
        qos = _compatible_qos(publishers) if publishers or self._qos is None else self._qos
        if qos != self._qos:
            self._unsubscribe()
            self._qos = qos
            self._subscription = self._node.create_subscription(self._cls, self._name, self._heard, qos, raw=True)

    def end(self) -> None:
        """Stop listening."""
        self._unsubscribe()
        self._stop_timer()

    def _fit(self) -> None:
        """Use the shortest period and the longest queue of all subscriptions."""
        period = min(period for period, _ in self._wanted.values())
        self._depth = max(depth for _, depth in self._wanted.values())
        if period != self._period:
            self._stop_timer()
            self._period = period
            if period:
                clock = Clock(clock_type=ClockType.STEADY_TIME)
                self._timer = self._node.create_timer(period, self._on_period, clock=clock)
                self._timer.cancel()

    def _heard(self, message: bytes) -> None:
        if self._timer is None:
            self._pass_on(message)
        elif self._timer.is_canceled():
            self._timer.reset()
            self._pass_on(message)
        else:
            self._newest = message

    def _on_period(self) -> None:
        newest, self._newest = self._newest, None
        if newest is None:
            self._timer.cancel()
        else:
            self._pass_on(newest)

    def _pass_on(self, message: bytes) -> None:
        text = "" if len(message) > _MOST_BYTES else json.dumps(as_data(deserialize_message(message, self._cls)))
        text = f'{{"op":"publish","topic":{json.dumps(self._topic)},"msg":{text}}}'
        if len(message) <= _MOST_BYTES and len(text) <= MOST_CHARACTERS:
            self._deliver(self._topic, text, self._depth)
        elif not self._has_refused:
            self._has_refused = True
            self._refuse(f"Messages of {self._topic} with more than {MOST_CHARACTERS:,} characters are left out.")

    def _unsubscribe(self) -> None:
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    def _stop_timer(self) -> None:
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = self._newest = None


class Publisher:
    """One topic that one client publishes. Raises BridgeError, also for a type that isn't the topic's."""

    def __init__(self, node: Node, topic: str, asked: dict[str, Any]) -> None:
        self._node, self._topic = node, topic
        name = full(topic)
        types = types_of(node, "publisher", name) | types_of(node, "listener", name)
        if asked.get("type") in (None, "") and not types:
            raise BridgeError(f"The type of {topic} isn't known. Advertise it with a type first.")
        self.cls = type_of(str(asked.get("type") or min(types)), "msg")
        if types and type_name(self.cls) not in types:
            raise BridgeError(f"{name} is of the type {min(types)}, not {type_name(self.cls)}.")
        latched = asked.get("latch") is True
        durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
        self._publisher = node.create_publisher(self.cls, name, QoSProfile(depth=_DEPTH, durability=durability))

    def publish(self, fields: object) -> None:
        """Publish these fields. Raises BridgeError if they don't fit."""
        self._publisher.publish(fill_message(self.cls, fields, self._node.get_clock().now().to_msg))

    def end(self) -> None:
        """Stop publishing, once the last message, which may be a stop, has been heard."""
        self._publisher.wait_for_all_acked(_HEARD)
        self._node.destroy_publisher(self._publisher)


def full(name: str) -> str:
    """Return a topic's name as the graph has it: clients may leave out the first slash."""
    return f"/{name.removeprefix('/')}"


def _compatible_qos(publishers: list[Any]) -> QoSProfile:
    """Return a quality of service that hears all publishers, and keeps messages for late
    listeners if all of them do.
    """
    latched = bool(publishers) and all(
        each.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for each in publishers
    )
    reliable = bool(publishers) and all(
        each.qos_profile.reliability == ReliabilityPolicy.RELIABLE for each in publishers
    )
    return QoSProfile(
        depth=_MOST_DEPTH if latched else _DEPTH,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
    )

"""The clients of a server, each with what it hears, publishes, calls and lets a robot do."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from btlang.ros.bridge.calls import BridgeCall, BridgeGoal, Servers
from btlang.ros.bridge.replies import MOST_CHARACTERS, BridgeError, failures, reason_of
from btlang.ros.bridge.topics import Publisher, Subscription

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Asked: TypeAlias = dict[str, Any]
    Write: TypeAlias = Callable[[Asked, str], object]

_LOOK = 0.25  # seconds between two looks at who publishes
_MOST = {"subscriptions": 100, "publishers": 100, "calls": 50, "goals": 20}
"""Limits for one client."""
_FEEDBACK = 10  # messages that wait for a client


class Bridge:
    """The clients of a server, for the thread that spins `node`.

    `write` gets the `client` that a text is for, its `topic` ("" for an answer), how many texts of that topic to keep
    (`most`, the newest), and the text.
    """

    def __init__(self, node: Node, write: Write) -> None:
        self.servers = Servers(node)
        self._node, self._write = node, write
        self._clients: dict[int, _BridgeClient] = {}
        self._leaving: list[BridgeGoal] = []
        node.create_timer(_LOOK, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def take(self, line: bytes) -> None:
        """Do what a line of a client asks for."""
        asked: Asked = json.loads(line)
        number = asked.pop("client")
        if asked["op"] == "leave":
            self._leave(number)
            return
        if number not in self._clients:
            self._clients[number] = _BridgeClient(self._node, self.servers, partial(self._send, number))
        client = self._clients[number]
        try:
            client.do[asked["op"]](asked)
        except Exception as error:  # of ROS, too: whoever asks must not end what others use
            client.fail(asked, reason_of(error))

    def left(self) -> list[BridgeGoal]:
        """Return the goals that were cancelled and haven't ended."""
        self._leaving = [goal for goal in self._leaving if not goal.ended]
        return self._leaving

    def close(self) -> None:
        """Disconnect all clients."""
        for number in tuple(self._clients):
            self._leave(number)

    def _leave(self, number: int) -> None:
        client = self._clients.pop(number, None)
        if client is not None:
            self._leaving = self.left() + client.leave()

    def _look(self) -> None:
        for client in self._clients.values():
            client.look()

    def _send(self, number: int, text: str, topic: str = "", most: int = 0) -> None:
        if number in self._clients:
            self._write({"client": number, "topic": topic, "most": most}, text)


class _BridgeClient:
    def __init__(self, node: Node, servers: Servers, send: Callable[..., object]) -> None:
        self._node, self._servers, self._send = node, servers, send
        self._subscriptions: dict[str, tuple[Subscription, Asked]] = {}
        self._publishers: dict[str, Publisher] = {}
        self._calls: list[BridgeCall] = []
        self._goals: dict[object, BridgeGoal] = {}
        self.do: dict[str, Callable[[Asked], object]] = {
            "subscribe": self._subscribe, "unsubscribe": self._unsubscribe, "advertise": self._advertise,
            "unadvertise": self._unadvertise, "publish": self._publish, "call_service": self._call,
            "send_action_goal": self._send_goal, "cancel_action_goal": self._cancel_goal,
        }  # fmt: skip

    def fail(self, asked: Asked, text: str) -> None:
        """Send the client the reason why something isn't done."""
        for message in failures(asked, text):
            self._send(json.dumps(message))

    def look(self) -> None:
        """Update the subscriptions as the graph changes."""
        for topic in tuple(self._subscriptions):
            self._look_at(topic)

    def leave(self) -> list[BridgeGoal]:
        """End everything of this client; return the goals to cancel, which may take a moment to end."""
        for goal in self._goals.values():
            goal.cancel()
        for call in self._calls:
            call.end()
        for subscription, _ in self._subscriptions.values():
            subscription.end()
        for publisher in self._publishers.values():
            publisher.end()
        return list(self._goals.values())

    def _subscribe(self, asked: Asked) -> None:
        topic = asked["topic"]
        subscription, _ = self._subscriptions.get(topic, (None, None))
        if subscription is None:
            _check("subscriptions", len(self._subscriptions))
            deliver = lambda topic, text, most: self._send(text, topic, most)  # noqa: E731
            subscription = Subscription(self._node, topic, deliver, partial(self.fail, asked))
        subscription.add_request(asked)
        self._subscriptions[topic] = subscription, asked
        self._look_at(topic)

    def _look_at(self, topic: str) -> None:
        subscription, asked = self._subscriptions[topic]
        try:
            subscription.look()
        except Exception as error:
            self._subscriptions.pop(topic)[0].end()
            self.fail(asked, reason_of(error))

    def _unsubscribe(self, asked: Asked) -> None:
        topic = asked["topic"]
        if topic not in self._subscriptions:
            raise BridgeError(f"You haven't subscribed to {topic}.")
        if self._subscriptions[topic][0].remove_request(asked.get("id")):
            self._subscriptions.pop(topic)[0].end()

    def _advertise(self, asked: Asked) -> None:
        topic = asked["topic"]
        _check("publishers", len(self._publishers.keys() - {topic}))
        made = Publisher(self._node, topic, asked)
        if topic in self._publishers:
            self._publishers[topic].end()
        self._publishers[topic] = made

    def _unadvertise(self, asked: Asked) -> None:
        if asked["topic"] not in self._publishers:
            raise BridgeError(f"You haven't advertised {asked['topic']}.")
        self._publishers.pop(asked["topic"]).end()

    def _publish(self, asked: Asked) -> None:
        if asked["topic"] not in self._publishers:
            self._advertise({"topic": asked["topic"]})
        self._publishers[asked["topic"]].publish(asked.get("msg", {}))

    def _call(self, asked: Asked) -> None:
        self._calls = [call for call in self._calls if not call.ended]
        _check("calls", len(self._calls))
        self._calls.append(BridgeCall(self._servers, asked, partial(self._answer, asked), partial(self.fail, asked)))

    def _send_goal(self, asked: Asked) -> None:
        self._goals = {id: goal for id, goal in self._goals.items() if not goal.ended}
        _check("goals", len(self._goals))
        id = object() if asked.get("id") is None else asked["id"]
        if id in self._goals:
            raise BridgeError("A goal with this id is running.")
        reply, fail = partial(self._answer, asked), partial(self.fail, asked)
        self._goals[id] = BridgeGoal(self._servers, asked, reply, fail, partial(self._feedback, id))

    def _cancel_goal(self, asked: Asked) -> None:
        goal = self._goals.get(asked.get("id"))
        if goal is None or goal.ended:
            raise BridgeError(f"No goal of yours for {asked['action']} has this id.")
        goal.cancel()

    def _feedback(self, id: object, message: Asked) -> None:
        text = json.dumps(message)
        if len(text) <= MOST_CHARACTERS:
            self._send(text, f"feedback {id}", _FEEDBACK)

    def _answer(self, asked: Asked, message: Asked) -> None:
        text = json.dumps(message)
        if len(text) > MOST_CHARACTERS:
            self.fail(asked, f"The answer has {len(text):,} characters, more than {MOST_CHARACTERS:,}.")
        else:
            self._send(text)


def _check(what: str, count: int) -> None:
    if count >= _MOST[what]:
        raise BridgeError(f"You have {count} {what} already, which is the most.")

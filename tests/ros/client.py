"""A program of a user, with rclpy alone: what it hears, and how it asks."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import closing
from threading import Condition, Event
from typing import Any

from rclpy.action import ActionClient
from rclpy.qos import DurabilityPolicy, QoSProfile
from unique_identifier_msgs.msg import UUID

from btlang.ros.node import SpunNode
from tests.ros.processes import LONG, wait_until

LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # none is replaced before it is read

_ALL_FOUND = 1.0  # seconds: nodes of tests announce themselves every 0.1 s
_PATIENCE = 10.0  # seconds for one node, before the next one is asked
_SETTLE = 0.3  # seconds: a server that has not yet found the client's reader drops its answer, and no call tells when


class Heard:
    """The messages of a topic, from the subscription on."""

    def __init__(self) -> None:
        self.messages: list[Any] = []
        self._news = Condition()

    def __call__(self, message: Any) -> None:
        with self._news:
            self.messages.append(message)
            self._news.notify_all()

    def wait(self, wanted: Callable[[Any], object] = lambda message: True, since: int | None = None) -> Any:
        """The first message from number `since` on (by default the last one) that is as wanted."""
        with self._news:
            at = max(len(self.messages) - 1, 0) if since is None else since

            def found() -> bool:
                nonlocal at
                while at < len(self.messages) and not wanted(self.messages[at]):
                    at += 1
                return at < len(self.messages)

            assert self._news.wait_for(found, LONG), f"{len(self.messages)} messages, last: {self.messages[-1:]}"
            return self.messages[at]

    def next(self) -> Any:
        """A message that is not there yet."""
        with self._news:
            count = len(self.messages)
            assert self._news.wait_for(lambda: len(self.messages) > count, LONG), f"no message after {count}"
            return self.messages[count]


class Client:
    """A node that is spun in the background. Every wait has an end."""

    def __init__(self, domain: int) -> None:
        self._spun = SpunNode("client", domain_id=domain)
        self.node = self._spun.node
        self._found: dict[str, Any] = {}
        self._spun.start()

    def close(self) -> None:
        self._spun.close()

    def hear(self, kind: type[Any], topic: str, qos: QoSProfile | int = 10) -> Heard:
        heard = Heard()
        self.node.create_subscription(kind, topic, heard, qos)
        return heard

    def publisher(self, kind: type[Any], topic: str) -> Any:
        """A publisher that somebody listens to."""
        publisher = self.node.create_publisher(kind, topic, 10)
        wait_until(publisher.get_subscription_count, f"a listener of {topic}")
        return publisher

    def call(self, kind: type[Any], service: str, **fields: Any) -> Any:
        client = self._settled(service, lambda: self.node.create_client(kind, service))
        assert client.wait_for_service(LONG), service
        return answer(client.call_async(kind.Request(**fields)))

    def action(self, kind: type[Any], name: str) -> ActionClient:
        client: ActionClient = self._settled(name, lambda: ActionClient(self.node, kind, name))
        assert client.wait_for_server(LONG), name
        return client

    def _settled(self, name: str, make: Callable[[], Any]) -> Any:
        """The client of that name, which its server has found; a server lives as long as the test."""
        if name not in self._found:
            client = self._found[name] = make()
            wait = client.wait_for_server if isinstance(client, ActionClient) else client.wait_for_service
            assert wait(LONG), name
            time.sleep(_SETTLE)
        return self._found[name]

    def begin(self, question: Callable[[], Any]) -> Any:
        """The future of an action client, asked for by the thread that spins: rclpy notes a question after it has
        sent it, and elsewhere the answer may come in between, and is lost."""
        return answer(self.node.executor.create_task(question))


class Goal:
    """A goal that was sent and answered, with what is heard of it."""

    def __init__(self, client: Client, server: ActionClient, goal: Any, goal_id: UUID | None = None) -> None:
        self.feedback = Heard()
        self._client = client
        self._handle = answer(
            client.begin(lambda: server.send_goal_async(goal, lambda message: self.feedback(message.feedback), goal_id))
        )
        self.accepted: bool = self._handle.accepted

    def ending(self) -> Any:
        """The future of the result."""
        return self._client.begin(self._handle.get_result_async)

    def result(self) -> Any:
        """Waits for it."""
        return answer(self.ending())

    def cancel(self) -> int:
        """Says how many goals are being cancelled."""
        return len(answer(self._client.begin(self._handle.cancel_goal_async)).goals_canceling)


def answer(future: Any) -> Any:
    """What a future of rclpy comes to."""
    done = Event()
    future.add_done_callback(lambda _: done.set())
    assert done.wait(LONG), "no answer"
    return future.result()


def check_nodes(domain: int, *names: str) -> None:
    """New nodes find these in the graph, and no others. Where a farewell gets lost, DDS misses one after 20 s.

    The graph of a node may keep another for ever: where its last words come after its farewell, rmw adds it anew. So
    there is a new node now and then.
    """
    wanted = sorted((*names, "client"))
    until = time.monotonic() + 2 * LONG
    found: list[str] = []
    while found != wanted and time.monotonic() < until:
        with closing(Client(domain)) as client:
            time.sleep(_ALL_FOUND)
            found = _settled_names(client, wanted, min(until, time.monotonic() + _PATIENCE))
    assert found == wanted, f"found {found}, not {wanted}"


def _settled_names(client: Client, wanted: list[str], until: float) -> list[str]:
    while (found := sorted(client.node.get_node_names())) != wanted and time.monotonic() < until:
        time.sleep(0.01)
    return found

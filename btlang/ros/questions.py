"""Services that are called from threads which wait for the answer, while another thread spins the node."""

from __future__ import annotations

import threading
from collections.abc import Callable

from rclpy.node import Node

from btlang.components.component import ComponentError
from btlang.engine.leaves.leaf import described
from btlang.ros.executor_thread import ExecutorThread
from btlang.ros.waiting import wait_until

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    T = TypeVar("T")

_DONE = 10.0  # seconds within which the thread that spins gets to something, on a busy computer


class Question:
    """A service that was called. `answer` is None until it has come."""

    def __init__(self) -> None:
        self.answer: Any = None
        self._come = threading.Event()

    def wait(self, seconds: float) -> Any:
        """The answer, None if there is none by then."""
        self._come.wait(seconds)
        return self.answer

    def came(self, future: Any) -> None:
        """In the thread that spins."""
        self.answer = future.result()
        self._come.set()


class Questions:
    """For any thread but the one that spins the node."""

    def __init__(self, node: Node) -> None:
        self._node, self._executor = node, ExecutorThread(node)

    def do(self, work: Callable[[Node], T]) -> T:
        """What the thread that spins makes of the node. Raises ComponentError where it can't, or doesn't get to it."""
        results: list[T] = []
        problems: list[str] = []

        def try_it() -> None:
            try:
                results.append(work(self._node))
            except Exception as problem:
                problems.append(described(problem))

        self._executor.post(try_it)
        wait_until(lambda: results or problems, _DONE)
        if not results:
            raise ComponentError(f"can't be asked: {problems[0] if problems else 'the thread of ROS 2 hangs'}")
        return results[0]

    def begin(self, client: Any, request: Any) -> Question:
        """Calls a service, and waits for nothing."""
        question = Question()
        self._executor.post(lambda: client.call_async(request).add_done_callback(question.came))
        return question

    def ask(self, client: Any, request: Any, seconds: float) -> Any:
        """What a service answers; None where it doesn't in time, or isn't there by then."""
        wait_until(client.service_is_ready, seconds)
        return self.begin(client, request).wait(seconds) if client.service_is_ready() else None

    def is_there(self, name: str) -> bool:
        """Whether the graph has a node of this full name."""
        nodes = self._node.get_node_names_and_namespaces()
        return any(f"{namespace.rstrip('/')}/{node}" == name for node, namespace in nodes)

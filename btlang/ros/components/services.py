"""Services called from threads that wait for the answer, and containers that load C++ nodes by them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib import import_module

from rclpy.node import Node
from rclpy.parameter import Parameter

from btlang.components.component import ComponentAbsent, ComponentError
from btlang.engine.leaves.leaf import describe_exception
from btlang.ros.clocks import wait_until
from btlang.ros.node import ExecutorThread

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from btlang.robots.bodies.body import RosNode

    T = TypeVar("T")

_DONE = 10.0  # seconds within which the thread that spins gets to something, on a busy computer
_DISCOVERY = 7.0  # seconds in which a container that is there is found
_UNLOAD = 3.0
_NAMES = {"LoadNode": "load_node", "UnloadNode": "unload_node", "ListNodes": "list_nodes"}


class AwaitedReply:
    """The reply to a service call. `answer` is None until it has come."""

    def __init__(self) -> None:
        self.answer: Any = None
        self._come = threading.Event()

    def wait(self, seconds: float) -> Any:
        """Wait for the answer; return None if it doesn't come in time."""
        self._come.wait(seconds)
        return self.answer

    def came(self, future: Any) -> None:
        """Store the answer, in the thread that spins."""
        self.answer = future.result()
        self._come.set()


class ServiceCaller:
    """Calls services, from any thread but the one that spins the node."""

    def __init__(self, node: Node) -> None:
        self._node, self._executor = node, ExecutorThread(node)

    def do(self, work: Callable[[Node], T]) -> T:
        """Run a function of the node in the thread that spins; return its result.

        Raises ComponentError if it fails, or doesn't run in time.
        """
        results: list[T] = []
        problems: list[str] = []

        def try_it() -> None:
            try:
                results.append(work(self._node))
            except Exception as problem:
                problems.append(describe_exception(problem))

        self._executor.post(try_it)
        wait_until(lambda: results or problems, _DONE)
        if not results:
            raise ComponentError(f"can't be asked: {problems[0] if problems else 'the thread of ROS 2 hangs'}")
        return results[0]

    def begin(self, client: Any, request: Any) -> AwaitedReply:
        """Call a service without waiting."""
        question = AwaitedReply()
        self._executor.post(lambda: client.call_async(request).add_done_callback(question.came))
        return question

    def ask(self, client: Any, request: Any, seconds: float) -> Any:
        """Call a service; return its answer, None if there is none in time."""
        wait_until(client.service_is_ready, seconds)
        return self.begin(client, request).wait(seconds) if client.service_is_ready() else None

    def is_there(self, name: str) -> bool:
        """Return whether the graph has a node with this full name."""
        nodes = self._node.get_node_names_and_namespaces()
        return any(f"{namespace.rstrip('/')}/{node}" == name for node, namespace in nodes)


class Container:
    """The container of one node. Each method waits for the answer for at most `limit` seconds."""

    def __init__(self, node: RosNode, questions: ServiceCaller, limit: float) -> None:
        self._node, self._questions, self._limit = node, questions, limit
        self._number: int | None = None

    def load(self, parameters: Mapping[str, Any]) -> None:
        """Load the node, and unload one with its name before. Raises ComponentError."""
        if not self._is_there(_DISCOVERY):
            raise ComponentAbsent(f"waits for the container {self._node.container}")
        listed = self._ask("ListNodes", self._limit)
        for name, number in zip(listed.full_node_names, listed.unique_ids, strict=False):
            if name == self._node.name:
                self._ask("UnloadNode", self._limit, unique_id=number)
        namespace, _, name = self._node.name.rpartition("/")
        values = [Parameter(each, value=value).to_parameter_msg() for each, value in parameters.items()]
        answer = self._ask(
            "LoadNode", self._limit, package_name=self._node.package, plugin_name=self._node.plugin, node_name=name,
            node_namespace=namespace or "/", parameters=values,
        )  # fmt: skip
        if not answer.success:
            raise ComponentError(f"can't be loaded into {self._node.container}: {answer.error_message}")
        self._number = answer.unique_id

    def unload(self) -> None:
        """Unload the node if it is loaded and the container still exists. May be called twice."""
        number, self._number = self._number, None
        if number is not None and self._questions.is_there(self._node.container):
            try:
                self._ask("UnloadNode", _UNLOAD, unique_id=number)
            except ComponentError:  # the container hangs: its nodes end with it
                return

    def _is_there(self, seconds: float) -> bool:
        wait_until(lambda: self._questions.is_there(self._node.container), seconds)
        return self._questions.is_there(self._node.container)

    def _ask(self, service: str, limit: float, **fields: Any) -> Any:
        kind = getattr(import_module("composition_interfaces.srv"), service)
        name = f"{self._node.container}/_container/{_NAMES[service]}"
        make: Callable[[Node], Any] = lambda node: node.create_client(kind, name)  # noqa: E731
        client = self._questions.do(make)
        try:
            answer = self._questions.ask(client, kind.Request(**fields), limit)
        finally:
            with suppress(ComponentError):
                self._questions.do(lambda node: node.destroy_client(client))
        if answer is None:
            raise ComponentError(f"{name} has not answered within {limit:g} s")
        return answer

"""Component containers: processes into which C++ nodes are loaded (composition_interfaces)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib import import_module

from rclpy.node import Node
from rclpy.parameter import Parameter

from btlang.components.component import ComponentAbsent, ComponentError
from btlang.ros.waiting import wait_until

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.body import RosNode
    from btlang.ros.questions import Questions

_DISCOVERY = 7.0  # seconds in which a container that is there is found
_UNLOAD = 3.0


class Container:
    """That of one node. Each method waits for the answer, `limit` seconds at most."""

    def __init__(self, node: RosNode, questions: Questions, limit: float) -> None:
        self._node, self._questions, self._limit = node, questions, limit
        self._number: int | None = None

    def load(self, parameters: Mapping[str, Any]) -> None:
        """Loads the node; one of its name that is there already is unloaded before. Raises ComponentError."""
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
        """Where it was loaded and the container is still there. May be called twice."""
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


_NAMES = {"LoadNode": "load_node", "UnloadNode": "unload_node", "ListNodes": "list_nodes"}

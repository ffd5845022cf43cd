"""A component container that speaks composition_interfaces, as far as a robot asks it: `container.py NAME`."""

from __future__ import annotations

import sys
from contextlib import suppress
from typing import Any

import rclpy
from composition_interfaces.srv import ListNodes, LoadNode, UnloadNode
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python

from tests.ros.peers.lifecycle import ArmDriver


class Container:
    """Has one plugin, the arm driver. Nodes that are there at the start have nobody who leads them."""

    def __init__(self, node: Node, executor: Any) -> None:
        self._executor = executor
        self._nodes: dict[int, Any] = {}
        self._count = 0
        node.create_service(LoadNode, "~/_container/load_node", self._load)
        node.create_service(UnloadNode, "~/_container/unload_node", self._unload)
        node.create_service(ListNodes, "~/_container/list_nodes", self._list)

    def _load(self, request: Any, response: Any) -> Any:
        if (request.package_name, request.plugin_name) != ("arm", "arm::Driver"):
            response.error_message = f"could not find {request.plugin_name}"
            return response
        made = ArmDriver(request.node_name, namespace=request.node_namespace)
        values = {each.name: parameter_value_to_python(each.value) for each in request.parameters}
        made.set_parameters([rclpy.Parameter(name, value=value) for name, value in values.items()])
        self._count += 1
        self._nodes[self._count] = made
        self._executor.add_node(made)
        print("loaded", made.get_fully_qualified_name(), values, flush=True)
        response.success, response.unique_id = True, self._count
        response.full_node_name = made.get_fully_qualified_name()
        return response

    def _unload(self, request: Any, response: Any) -> Any:
        made = self._nodes.pop(request.unique_id, None)
        response.success = made is not None
        if made is not None:
            print("unloaded", made.get_fully_qualified_name(), flush=True)
            self._executor.remove_node(made)
            made.destroy_node()
        return response

    def _list(self, request: Any, response: Any) -> Any:
        response.full_node_names = [each.get_fully_qualified_name() for each in self._nodes.values()]
        response.unique_ids = list(self._nodes)
        return response


def main(name: str) -> None:
    """Until a signal comes."""
    rclpy.init()
    node, executor = rclpy.create_node(name), SingleThreadedExecutor()
    executor.add_node(node)
    kept = Container(node, executor)
    print("ready", flush=True)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()
    del kept


if __name__ == "__main__":
    main(*sys.argv[1:])

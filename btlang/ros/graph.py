"""What the ROS 2 graph says of servers, publishers and listeners that a leaf needs, and why they are not there."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.action import ActionClient, get_action_names_and_types

from btlang.ros.word import type_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def is_ready(client: Any) -> bool:
    """Whether there is a server for a client of an action or a service."""
    return bool(client.server_is_ready() if isinstance(client, ActionClient) else client.service_is_ready())


def no_server(node: Any, cls: Any, name: str) -> str:
    """Why there is no server of a type: nobody offers the name, or as another type."""
    if type_name(cls).split("/")[1] == "action":
        kind, offered = "action", get_action_names_and_types(node)
    else:
        kind, offered = "service", node.get_service_names_and_types()
    types = dict(offered).get(node.resolve_service_name(name), [])
    others = [other for other in types if other != type_name(cls)]
    if others:
        return f"the {kind} {name} is of the type {others[0]}, not {type_name(cls)}"
    return f"there is no {kind} server {name}"


def no_listener(node: Any, cls: Any, name: str) -> str:
    """Why nobody hears what is published."""
    return _other_type(cls, name, node.get_subscriptions_info_by_topic) or f"nobody listens to {name}"


def no_publisher(node: Any, cls: Any, name: str) -> str:
    """Why nothing comes on a topic, "" where it is only silent."""
    if not node.count_publishers(name):
        return f"nobody publishes {name}"
    return _other_type(cls, name, node.get_publishers_info_by_topic)


def _other_type(cls: Any, name: str, endpoints: Callable[[str], Any]) -> str:
    types = {end.topic_type for end in endpoints(name)}
    if types and type_name(cls) not in types:
        return f"the topic {name} is of the type {min(types)}, not {type_name(cls)}"
    return ""

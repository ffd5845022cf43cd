"""The ROS 2 graph: which servers, publishers and listeners exist, why one is missing, and names within it."""

from __future__ import annotations

import re
from collections.abc import Iterable

from rclpy.action import ActionClient, get_action_names_and_types
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from btlang.ros.messages import type_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_LONGEST = 50
_NOBODY = {
    "publisher": "nobody publishes {name}",
    "listener": "nobody listens to {name}",
    "service": "there is no service server {name}",
    "action": "there is no action server {name}",
}


def graph_names(names: Iterable[str], kind: str) -> dict[str, str]:
    """Return a token for each name: "lab_door" for "lab door".

    A name without letters that ROS 2 allows is called by its kind. A token that is taken gets a number, in the order of
    the names.
    """
    tokens: dict[str, str] = {}
    for name in names:
        token = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:_LONGEST].strip("_")
        first = token if token[:1].isalpha() else f"{kind}_{token}".strip("_")
        token, count = first, 1
        while token in tokens.values():
            count += 1
            token = f"{first}_{count}"
        tokens[name] = token
    return tokens


def is_connected(node: Node, name: str) -> bool:
    """Return whether somebody hears what the node publishes on a topic, or serves its client of a service.

    `name` is the full name. True if the node has neither.
    """
    heard = (publisher.get_subscription_count() > 0 for publisher in node.publishers if publisher.topic_name == name)
    served = (client.service_is_ready() for client in node.clients if client.service_name == name)
    return all(heard) and all(served)


def full_name(node: Any, kind: str, name: str) -> str:
    """Resolve a name in the namespace of the node, unless it has one. `kind` is that of an `Interface`."""
    resolve = node.resolve_topic_name if kind in ("publisher", "listener") else node.resolve_service_name
    return str(resolve(name))


def absent(node: Any, kind: str, name: str, wanted: Any) -> str:
    """Return why there is no publisher, listener, service or action: nobody has it, or it has another type; "" if it
    exists.

    `wanted` is the class of the type, or its name.
    """
    name, wanted = full_name(node, kind, name), type_name(wanted)
    types = types_of(node, kind, name)
    others = sorted(types - {wanted})
    if kind in ("publisher", "listener"):
        if wanted in types:
            return ""
    elif not others and node.count_services(name if kind == "service" else f"{name}/_action/send_goal"):
        return ""  # the types alone do not show it: those of clients are among them
    if others:
        sort = kind if kind in ("service", "action") else "topic"
        return f"the {sort} {name} is of the type {others[0]}, not {wanted}"
    return _NOBODY[kind].format(name=name)


def mismatch(node: Any, kind: str, name: str) -> str:
    """Return why nothing on a topic can be exchanged with anybody, "" if it can.

    Only reliability and durability count: rclpy reports limits of time even if they aren't set differently at both
    ends.
    """
    heard = kind == "publisher"
    name = full_name(node, kind, name)
    own = [each.qos_profile for each in (node.subscriptions if heard else node.publishers) if each.topic_name == name]
    infos = (node.get_publishers_info_by_topic if heard else node.get_subscriptions_info_by_topic)(name)
    others = [each.qos_profile for each in infos]
    lacks = [_weaker_policies(*((other, each) if heard else (each, other))) for each in own for other in others]
    if not lacks or not all(lacks):
        return ""
    sent, asked = (
        " and ".join(each.name.lower().replace("_", " ") for each in side) for side in zip(*lacks[0], strict=True)
    )
    who = (
        f"{name} is published as {sent}, but btlang"
        if heard
        else f"btlang publishes {name} as {sent}, but its listener"
    )
    return f"{who} asks for {asked}: the quality of service doesn't match"


def _weaker_policies(offered: QoSProfile, requested: QoSProfile) -> list[tuple[Any, Any]]:
    """Return the policies of a publisher that are too weak, each with what the listener requests."""
    policies = (
        (offered.reliability, requested.reliability, ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE),
        (offered.durability, requested.durability, DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL),
    )
    return [(sent, asked) for sent, asked, weak, strong in policies if sent == weak and asked == strong]


def is_ready(client: Any) -> bool:
    """Return whether there is a server for a client of an action or a service."""
    return bool(client.server_is_ready() if isinstance(client, ActionClient) else client.service_is_ready())


def no_server(node: Any, cls: Any, name: str) -> str:
    """Return why a client has no server."""
    kind = type_name(cls).split("/")[1].replace("srv", "service")
    return absent(node, kind, name, cls) or f"the {kind} server {name} is not connected yet"


def no_listener(node: Any, cls: Any, name: str) -> str:
    """Return why nobody hears what is published."""
    why = absent(node, "listener", name, cls) or mismatch(node, "listener", name)
    return why or f"nobody listens to {name} yet"


def no_publisher(node: Any, cls: Any, name: str) -> str:
    """Return why nothing comes on a topic, "" if it is only silent."""
    return absent(node, "publisher", name, cls) or mismatch(node, "publisher", name)


def types_of(node: Any, kind: str, name: str) -> set[str]:
    """Return the types of a full name in the graph; `kind` is as in `absent`."""
    if kind == "publisher":
        return {end.topic_type for end in node.get_publishers_info_by_topic(name)}
    if kind == "listener":
        return {end.topic_type for end in node.get_subscriptions_info_by_topic(name)}
    offered = get_action_names_and_types(node) if kind == "action" else node.get_service_names_and_types()
    return set(dict(offered).get(name, ()))

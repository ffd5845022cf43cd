"""Whether a node has found its peers: the ROS graph shows them a moment before messages reach them."""

from __future__ import annotations

from rclpy.node import Node


def is_connected(node: Node, name: str) -> bool:
    """Whether somebody hears what the node publishes on a topic, or serves its client of a service.

    `name` is the full one. True where the node has neither.
    """
    heard = (publisher.get_subscription_count() > 0 for publisher in node.publishers if publisher.topic_name == name)
    served = (client.service_is_ready() for client in node.clients if client.service_name == name)
    return all(heard) and all(served)

"""Before a run: whether the robot has what the mission needs, found within a limit of time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable

from rclpy.node import Node

from btlang.ros.connected import is_connected
from btlang.ros.inbox import Inbox
from btlang.ros.wire import Interface

DISCOVERY = 2.0  # seconds of real time
_LOOK = 0.05


def preflight(node: Node, inbox: Inbox, needed: Iterable[Interface], limit: float = DISCOVERY) -> dict[Interface, str]:
    """What is wrong with each interface, "" where nothing is. Returns as soon as all is there, or after `limit`."""
    until = time.monotonic() + limit
    found = dict.fromkeys(needed, "")
    while True:
        found = {interface: _LOOKS[interface.kind](node, inbox, interface) for interface in found}
        if not any(found.values()) or time.monotonic() >= until:
            return found
        time.sleep(_LOOK)


def _tells(node: Node, inbox: Inbox, wanted: Interface) -> str:
    reason = _topic(wanted, node.get_publishers_info_by_topic(wanted.name), "nothing publishes it")
    if not reason and wanted.flows and not inbox.has(wanted.name):
        return "nothing comes on it"
    return reason


def _listens(node: Node, _: Inbox, wanted: Interface) -> str:
    reason = _topic(wanted, node.get_subscriptions_info_by_topic(wanted.name), "nothing subscribes to it")
    return reason or _unconnected(node, wanted)


def _topic(wanted: Interface, ends: Iterable[object], nobody: str) -> str:
    types = {str(getattr(end, "topic_type", "")) for end in ends}
    return "" if wanted.type in types else _other(types, wanted) if types else nobody


def _serves(node: Node, _: Inbox, wanted: Interface) -> str:
    return _service(node, wanted.name, wanted, "nothing serves it") or _unconnected(node, wanted)


def _unconnected(node: Node, wanted: Interface) -> str:
    return "" if is_connected(node, wanted.name) else "it is not connected yet"


def _acts(node: Node, _: Inbox, wanted: Interface) -> str:
    return _service(node, f"{wanted.name}/_action/send_goal", wanted, "nothing serves it")


def _service(node: Node, name: str, wanted: Interface, nobody: str) -> str:
    if not node.count_services(name):
        return nobody
    types = {kind.removesuffix("_SendGoal") for found, kinds in node.get_service_names_and_types() for kind in kinds
             if found == name}  # fmt: skip
    return _other(types - {wanted.type}, wanted) if types - {wanted.type} else ""


def _other(types: set[str], wanted: Interface) -> str:
    return f"it is {' and '.join(sorted(types))} instead of {wanted.type}"


_LOOKS: dict[str, Callable[[Node, Inbox, Interface], str]] = {
    "tells": _tells, "listens": _listens, "serves": _serves, "acts": _acts,
}  # fmt: skip

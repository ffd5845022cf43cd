"""A node that is spun in the background: what becomes of its thread."""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest
from rclpy.action import ActionClient, ActionServer
from std_msgs.msg import String

from btlang.diagnostics.diagnostic import MissionError
from btlang.ros.node import SpunNode
from tests.ros.client import check_nodes
from tests.ros.processes import wait_until


def test_a_callback_that_raises_does_not_end_the_others(domain: int, capfd: pytest.CaptureFixture[str]):
    heard = []

    def hear(message: String) -> None:
        heard.append(message.data)
        raise ValueError("no such thing")

    with SpunNode("listener", domain_id=domain) as spun:
        spun.node.create_subscription(String, "news", hear, 10)
        publisher = spun.node.create_publisher(String, "news", 10)
        wait_until(publisher.get_subscription_count, "the listener")
        for count in (1, 2):
            publisher.publish(String(data="hello"))
            wait_until(lambda count=count: len(heard) == count, f"message {count}")
    told = capfd.readouterr().err
    assert "ValueError: no such thing" in told
    assert "Traceback" not in told


def test_it_may_be_closed_twice_and_before_it_starts(domain: int):
    before = threading.active_count()
    never_started = SpunNode("idle", domain_id=domain)
    never_started.close()
    never_started.close()
    with SpunNode("busy", domain_id=domain) as spun:
        pass
    spun.close()
    assert threading.active_count() == before


@pytest.mark.parametrize("make", [ActionClient, partial(ActionServer, execute_callback=print)])
def test_a_node_with_actions_leaves_the_graph_when_it_is_closed(make: Callable[..., object], nav2: Any, domain: int):
    """And not when Python next collects garbage."""
    gc.collect()  # what other tests have left
    gc.disable()
    try:
        with SpunNode("leaves", domain_id=domain) as spun:
            make(spun.node, nav2, "navigate")
            check_nodes(domain, "leaves")
        check_nodes(domain)
    finally:
        gc.enable()


def test_a_domain_that_cannot_be():
    with pytest.raises(MissionError, match="BT100: ROS 2 can't be used: ROS_DOMAIN_ID must be from 0 to 232, not 233"):
        SpunNode("node", domain_id=233)

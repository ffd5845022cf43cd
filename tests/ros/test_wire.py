"""What the shipped leaves need of a ROS 2 robot. Needs no ROS 2."""

from __future__ import annotations

from btlang.api import world_vocabulary
from btlang.ros.wire import CAPABILITIES, LEAVES


def test_all_shipped_leaves_are_listed() -> None:
    assert set(LEAVES) == set(world_vocabulary().entries)


def test_all_capabilities_are_used() -> None:
    assert {capability for capabilities in LEAVES.values() for capability in capabilities} == set(CAPABILITIES)

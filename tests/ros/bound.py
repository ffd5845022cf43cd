"""All words of a keyword file bound to ROS 2 interfaces, for tests of what is said where that fails."""

from __future__ import annotations

import os
import sys
from typing import Any

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.vocabulary.load import load_vocabulary
from tests.ros.domains import free_domain


def bind_words(file: str) -> int:
    """Prints what is wrong and returns the exit code, as `btc` does. Skips where ROS 2 is not installed."""
    pytest.importorskip("rclpy", reason="ROS 2 is not installed")
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    from btlang.ros.node import SpunNode
    from btlang.ros.words.binding import bind_ros
    from btlang.ros.words.clients import RosClients

    vocabulary = load_vocabulary([file])
    problems = []
    with free_domain() as domain, SpunNode("bound", domain_id=domain) as spun:
        clients = RosClients(spun.node)
        for entry in (entry for same in vocabulary.entries.values() for entry in same):
            try:
                bind_ros(entry, vocabulary, clients, dict[str, Any]().__getitem__)
            except MissionError as error:
                problems += error.diagnostics
    if not problems:
        return 0
    print(MissionError(problems), file=sys.stderr)
    return 2

"""When something is published: at a rate of the simulated time, or when it changes."""

from __future__ import annotations

import math
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.node import Node

from btlang.ros.node import LATCHED
from btlang.support.record import Record

COMMANDS = 10
"""How many commands of a topic may wait."""


class Moment(Record):
    """Seconds of simulated time since the start, and the stamp that messages of now carry."""

    seconds: float
    stamp: Time


class Every:
    """Due when it is first asked, then once a period of simulated time; at every step if steps are longer."""

    def __init__(self, hertz: float) -> None:
        self._period = 1 / hertz
        self._next = -math.inf

    def is_due(self, seconds: float) -> bool:
        """Whether it is now; what has been missed is not caught up with."""
        if seconds < self._next - 1e-6:
            return False
        self._next += self._period
        if self._next < seconds:
            self._next = seconds + self._period
        return True


class Latched:
    """A topic with one value, `data`, that is published when it changes and kept for later subscribers."""

    def __init__(self, node: Node, kind: type[Any], topic: str, value: Any) -> None:
        self._kind = kind
        self._publisher = node.create_publisher(kind, topic, LATCHED)
        self._value = value
        self._publisher.publish(kind(data=value))

    def set(self, value: Any) -> None:
        """Publishes a value that is not the last one."""
        if value != self._value:
            self._value = value
            self._publisher.publish(self._kind(data=value))

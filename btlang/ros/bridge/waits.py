"""Waits for what the ROS graph doesn't report: polls in the thread that spins, for so many seconds at most."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from btlang.ros.bridge.replies import reason_of
from btlang.support.record import Record

_LOOK = 0.02  # seconds between two looks


class _Wait(Record):
    ready: Callable[[], object]
    then: Callable[[], object]
    late: Callable[[str], object]
    reason: Callable[[], str]
    until: float


class Waits:
    """Those of a node, which another thread spins."""

    def __init__(self, node: Node) -> None:
        self._waits: list[_Wait] = []
        self._timer = node.create_timer(_LOOK, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._timer.cancel()

    def when(
        self,
        ready: Callable[[], object],
        then: Callable[[], object],
        late: Callable[[str], object],
        reason: Callable[[], str],
        seconds: float,
    ) -> None:
        """Calls `then` once `ready` holds, or `late` with a reason: the given one, or why one of these two failed."""
        self._waits.append(_Wait(ready, then, late, reason, time.monotonic() + seconds))
        self._timer.reset()

    def _look(self) -> None:
        waits, self._waits = self._waits, []
        self._waits += [wait for wait in waits if not self._is_over(wait)]
        if not self._waits:
            self._timer.cancel()

    def _is_over(self, wait: _Wait) -> bool:
        try:
            if wait.ready():
                wait.then()
                return True
        except Exception as error:  # also of ROS: the others go on
            wait.late(reason_of(error))
            return True
        if time.monotonic() < wait.until:
            return False
        wait.late(wait.reason())
        return True

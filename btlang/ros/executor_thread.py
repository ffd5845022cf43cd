"""What is handed to the thread that spins a node.

rclpy's clients lose an answer that comes while another thread still sends the request. So all requests are made in the
thread that spins.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from rclpy.node import Node

from btlang.engine.leaves.leaf import described


class ExecutorThread:
    """Runs callables one after the other. `problems` are raised errors that could not be reported at once."""

    def __init__(self, node: Node) -> None:
        self.problems: list[str] = []
        self._posted: deque[Callable[[], object]] = deque()
        self._guard = node.create_guard_condition(self._work)

    def post(self, work: Callable[[], object]) -> None:
        """Lets the thread that spins do it; from any thread and from handlers of signals, in the order of calls."""
        self._posted.append(work)
        self._guard.trigger()

    @property
    def left(self) -> int:
        """How many are not done yet."""
        return len(self._posted)

    def _work(self) -> None:
        while self._posted:
            work = self._posted[0]
            try:
                work()
            except Exception as problem:  # it would end the thread that spins
                self.problems.append(described(problem))
            self._posted.popleft()  # only now, so that it counts as left until it is done

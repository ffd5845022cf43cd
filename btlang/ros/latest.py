"""The latest message of a topic, and how old it is."""

from __future__ import annotations

import time
from collections.abc import Callable

from btlang.engine.leaf import ActionFailed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

AGE = 5.0
"""Seconds after which what came last no longer counts, where a table says nothing else."""
_STANDING = 1.0  # real seconds for which the clock of a simulation may stand still, as it does between its ticks


class NodeClock:
    """The clock of a node in seconds, from any thread.

    Where simulated time stands still because nobody gives it, real time counts on, so that a limit is always reached.
    """

    def __init__(self, node: Any) -> None:
        self._clock = node.get_clock()
        self._seen = (-1.0, 0.0)  # what the clock said, and when it said so first; replaced as one

    def now(self) -> float:
        """Seconds of the node's clock."""
        said = self._clock.now().nanoseconds * 1e-9
        if said != self._seen[0]:
            self._seen = (said, time.monotonic())
        return float(said + max(0.0, time.monotonic() - self._seen[1] - _STANDING))

    def message(self) -> Any:
        """The time as builtin_interfaces/Time."""
        return self._clock.now().to_msg()


class Latest:
    """What came last. `store` is for the thread of the callbacks, all else for any one.

    `named` is what it is called, such as "/scan"; `absence` tells why nothing may have come, "" for no known reason.
    """

    def __init__(self, named: str, now: Callable[[], float], absence: Callable[[], str]) -> None:
        self.named = named
        self._now = now
        self._absence = absence
        self._last: tuple[Any, float] | None = None  # with its time of arrival

    @property
    def has_come(self) -> bool:
        """Whether there is any message."""
        return self._last is not None

    def store(self, message: Any) -> None:
        """Keeps a message in place of the one before."""
        self._last = message, self._now()

    def take(self, age: float | None = AGE) -> Any:
        """The message, not older than so many seconds; None for any age. Raises ActionFailed with the reason."""
        last = self._last
        if last is None:
            raise ActionFailed(self.why_not())
        silence = self._now() - last[1]
        if age is not None and silence > age:
            raise ActionFailed(self._absence() or f"nothing has come on {self.named} for {silence:.1f} s")
        return last[0]

    def why_not(self) -> str:
        """Why nothing has come, "" where something has."""
        if self.has_come:
            return ""
        return self._absence() or f"nothing has come on {self.named} yet"

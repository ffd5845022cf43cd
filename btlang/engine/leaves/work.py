"""The work of one background leaf, shared by the thread that does it and the one that ticks."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from threading import Event

from btlang.engine.leaves.leaf import ActionFailed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class TickCall:
    """A call that the thread of a work hands over to the one that ticks."""

    __slots__ = ("call", "done", "problem", "result")

    def __init__(self, call: Callable[[], object]) -> None:
        self.call = call
        self.done = Event()
        self.result: object = None
        self.problem: BaseException | None = None


class Work:
    """A run of a background leaf. `ended` is set when it is over; its `result` or its `problem` is set by then.

    `proxies` are what it got in place of services that are not safe beside the tick.
    """

    __slots__ = ("_requests", "_wake", "cancel", "ended", "halted", "problem", "proxies", "result")

    def __init__(self, wake: Callable[[], object]) -> None:
        self._wake = wake
        self._requests: deque[TickCall] = deque()
        self.proxies: dict[str, Any] = {}
        self.halted = Event()
        self.ended = Event()
        self.result: object = None
        self.problem: BaseException | None = None
        self.cancel: Callable[[], object] = self.halted.set
        """Asks it to end, from the thread that ticks."""

    def in_tick(self, call: Callable[[], Any]) -> Any:
        """Call something in the thread that ticks, at the next tick of the leaf, which comes at once. Returns or raises
        as it does.

        For the threads of the work. Raises ActionFailed once the work was halted or is over.
        """
        request = TickCall(call)
        self._requests.append(request)
        self._wake()
        if self.halted.is_set() or self.ended.is_set():
            self.refuse()
        request.done.wait()
        if request.problem is not None:
            raise request.problem
        return request.result

    def serve(self) -> None:
        """Make the calls that were handed over before now."""
        for _ in range(len(self._requests)):
            request = self._requests.popleft()
            try:
                request.result = request.call()
            except KeyboardInterrupt:
                self._requests.appendleft(request)
                raise
            except BaseException as problem:
                request.problem = problem
            request.done.set()

    def refuse(self) -> None:
        """Refuse all calls that were handed over. Any thread may call it."""
        while True:
            try:
                request = self._requests.popleft()
            except IndexError:
                return
            request.problem = ActionFailed("it was halted")
            request.done.set()

    def let_go(self) -> None:
        """End what it has begun with its services."""
        for proxy in self.proxies.values():
            proxy.let_go()
